"""Long verbs outside of the tick: inline, in a thread, or in a worker process per plugin.

In lock-step a job is charged its declared latency on the mission's clock, and its result is awaited
when that has passed; so the three runners give the same journal, byte for byte.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, ParamSpec, TypeVar

from executive.clock import Clock, wall_s
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.leaf.job import Job
from executive.mission.assembly import Selections, selected_plugins
from executive.mission.worker import VerbCall, Worker

_EPSILON_S = 1e-9

Arguments = ParamSpec("Arguments")
Value = TypeVar("Value")


class Runner(ABC):
    """Decides where a verb is computed."""

    @abstractmethod
    def submit(self, capability: str, plugin: Plugin, call: VerbCall) -> Future[Any]:
        """Begin a computation."""

    def abandon(self, capability: str, future: Future[Any]) -> None:  # noqa: B027 - optional
        """Drop the result of a computation that has begun; by default it is left to end."""

    def close(self) -> None:  # noqa: B027 - optional
        """End what was begun."""


class InlineRunner(Runner):
    """Computes at once, in the tick."""

    def submit(self, capability: str, plugin: Plugin, call: VerbCall) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(call.of(plugin))
        except Exception as error:
            future.set_exception(error)
        return future


class ThreadRunner(InlineRunner):
    """One thread for all stateless plugins; they share plugins, so no two verbs run at once.

    A plugin with state, such as a survey that looks at the simulated world, is computed inline:
    beside the tick it would see the world at no time in particular.
    """

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="jobs")

    def submit(self, capability: str, plugin: Plugin, call: VerbCall) -> Future[Any]:
        if not plugin.is_stateless:
            return super().submit(capability, plugin, call)
        return self._pool.submit(call.of, plugin)

    def close(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)


class ProcessRunner(InlineRunner):
    """One worker process a stateless plugin; plugins with state are computed inline."""

    def __init__(self, selections: Selections, model: str, seed: int) -> None:
        self._workers: dict[str, Worker] = {}
        self._make: Callable[[str], Worker] = lambda capability: Worker(
            capability, selections, model, seed
        )

    def submit(self, capability: str, plugin: Plugin, call: VerbCall) -> Future[Any]:
        if not plugin.is_stateless:
            return super().submit(capability, plugin, call)
        if capability not in self._workers:
            self._workers[capability] = self._make(capability)
        return self._workers[capability].submit(call)

    def abandon(self, capability: str, future: Future[Any]) -> None:
        if capability in self._workers:
            self._workers[capability].abandon(future)

    def close(self) -> None:
        for worker in self._workers.values():
            worker.close()


class PluginJob(Job[Value]):
    """One call of a verb that has begun."""

    def __init__(
        self,
        future: Future[Value],
        clock: Clock,
        ready_s: float | None,
        abandon: Callable[[Future[Value]], None],
    ) -> None:
        self._future = future
        self._abandon = abandon
        self._clock = clock
        self._ready_s = ready_s  # None: against the wall clock, ready when done

    def is_ready(self) -> bool:
        if self._ready_s is None:
            return self._future.done()
        return self._clock.now_s() >= self._ready_s - _EPSILON_S

    def result(self) -> Value:
        return self._future.result()

    def cancel(self) -> None:
        if not self._future.cancel():
            self._abandon(self._future)


class Jobs:
    """Starts jobs, charges their latency, and measures their wall time for the report."""

    def __init__(
        self, plugins: Mapping[str, Any], runner: Runner, clock: Clock, *, is_lock_step: bool
    ) -> None:
        self._plugins = plugins
        self._runner = runner
        self._clock = clock
        self._is_lock_step = is_lock_step
        self.durations_ms: dict[str, list[float]] = {}

    def start(
        self,
        verb: Callable[Arguments, Value],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> PluginJob[Value]:
        """Start a verb of a selected plugin.

        Raises:
            ConfigError: If the verb is no method of one of the mission's plugins.
        """
        capability, plugin = self._plugin_of(verb)
        call = VerbCall(verb.__name__, args, dict(kwargs))
        started_s = wall_s()
        future = self._runner.submit(capability, plugin, call)
        future.add_done_callback(lambda _: self._measure(f"{capability}.{call.verb}", started_s))
        latency_s = plugin.latency_s.get(call.verb, 0.0)
        ready_s = self._clock.now_s() + latency_s if self._is_lock_step else None
        return PluginJob(
            future,
            self._clock,
            ready_s,
            lambda given_up: self._runner.abandon(capability, given_up),
        )

    def _plugin_of(self, verb: Callable[..., Any]) -> tuple[str, Plugin]:
        owner = getattr(verb, "__self__", None)
        for capability, _, plugin in selected_plugins(self._plugins):
            if plugin is owner:
                return capability, plugin
        raise ConfigError(
            f"{getattr(verb, '__qualname__', verb)} is no method of a plugin of this mission; a "
            "job takes a verb of what `use` returns"
        )

    def _measure(self, stage: str, started_s: float) -> None:
        self.durations_ms.setdefault(stage, []).append(1e3 * (wall_s() - started_s))

    def close(self) -> None:
        """End all runners."""
        self._runner.close()
