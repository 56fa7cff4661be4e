"""Long verbs beside the tick: inline, in a thread, or in a long-lived worker process per plugin.

In lock-step a job is charged its declared latency on the mission's clock, and its result is awaited
when that has passed; so the three runners give the same journal, byte for byte.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from executive.clock import Clock, wall_s
from executive.interfaces.plugin import Plugin
from executive.leaf.job import Job
from executive.mission.assembly import Selections
from executive.mission.worker import Worker

_EPSILON_S = 1e-9


class Runner(ABC):
    """Decides where a verb is computed."""

    @abstractmethod
    def submit(
        self, capability: str, plugin: Plugin, verb: str, args: Sequence[Any]
    ) -> Future[Any]:
        """Begin a computation."""

    def abandon(self, capability: str, future: Future[Any]) -> None:  # noqa: B027 - optional
        """Take note that nobody waits for a computation that has begun; by default it is left to
        end.
        """

    def close(self) -> None:  # noqa: B027 - optional
        """End what was begun."""


class InlineRunner(Runner):
    """Computes at once, in the tick."""

    def submit(
        self, capability: str, plugin: Plugin, verb: str, args: Sequence[Any]
    ) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(getattr(plugin, verb)(*args))
        except Exception as error:
            future.set_exception(error)
        return future


class ThreadRunner(InlineRunner):
    """One thread for all stateless plugins: they share each other's parts, so no two of their verbs
    run at once.

    A plugin with state, such as a survey that looks at the simulated world, is computed inline:
    beside the tick it would see the world at no time in particular.
    """

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="jobs")

    def submit(
        self, capability: str, plugin: Plugin, verb: str, args: Sequence[Any]
    ) -> Future[Any]:
        if not plugin.is_stateless:
            return super().submit(capability, plugin, verb, args)
        return self._pool.submit(getattr(plugin, verb), *args)

    def close(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)


class ProcessRunner(InlineRunner):
    """One worker process a stateless plugin; plugins with state are computed inline."""

    def __init__(self, selections: Selections, model: str, seed: int) -> None:
        self._workers: dict[str, Worker] = {}
        self._make: Callable[[str], Worker] = lambda capability: Worker(
            capability, selections, model, seed
        )

    def submit(
        self, capability: str, plugin: Plugin, verb: str, args: Sequence[Any]
    ) -> Future[Any]:
        if not plugin.is_stateless:
            return super().submit(capability, plugin, verb, args)
        if capability not in self._workers:
            self._workers[capability] = self._make(capability)
        return self._workers[capability].submit(verb, args)

    def abandon(self, capability: str, future: Future[Any]) -> None:
        if capability in self._workers:
            self._workers[capability].abandon(future)

    def close(self) -> None:
        for worker in self._workers.values():
            worker.close()


class PluginJob(Job):
    """One verb under way."""

    def __init__(
        self,
        future: Future[Any],
        clock: Clock,
        ready_s: float | None,
        abandon: Callable[[Future[Any]], None],
    ) -> None:
        self._future = future
        self._abandon = abandon
        self._clock = clock
        self._ready_s = ready_s  # None: against the wall clock, ready when done

    def is_ready(self) -> bool:
        if self._ready_s is None:
            return self._future.done()
        return self._clock.now_s() >= self._ready_s - _EPSILON_S

    def result(self) -> Any:
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

    def start(self, capability: str, verb: str, args: Sequence[Any]) -> PluginJob:
        """Start a verb of the selected plugin."""
        plugin: Plugin = self._plugins[capability]
        started_s = wall_s()
        future = self._runner.submit(capability, plugin, verb, args)
        future.add_done_callback(lambda _: self._measure(f"{capability}.{verb}", started_s))
        latency_s = plugin.latency_s.get(verb, 0.0)
        ready_s = self._clock.now_s() + latency_s if self._is_lock_step else None
        return PluginJob(
            future,
            self._clock,
            ready_s,
            lambda given_up: self._runner.abandon(capability, given_up),
        )

    def _measure(self, stage: str, started_s: float) -> None:
        self.durations_ms.setdefault(stage, []).append(1e3 * (wall_s() - started_s))

    def close(self) -> None:
        """End all runners."""
        self._runner.close()
