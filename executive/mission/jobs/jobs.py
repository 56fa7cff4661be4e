"""Long verbs outside of the tick: inline, in a thread, or in a worker process per plugin.

In lock-step a job is charged its declared latency on the mission's clock, and its result is awaited
when that has passed; so the three runners give the same journal, byte for byte.
"""

import inspect
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any, ParamSpec, TypeVar

from executive.clock import Clock, wall_s
from executive.confined.memory import MemoryLimit
from executive.errors import ConfigError
from executive.events.mission import WorkerReplaced
from executive.faults.injector import Injector
from executive.interfaces.plugin import Plugin
from executive.leaf.job import Job
from executive.mission.assembly import selected_plugins
from executive.mission.jobs.answer import unfit
from executive.mission.jobs.call import Address, FunctionCall, VerbCall, WrongAnswerError
from executive.mission.jobs.faulty_call import decided
from executive.mission.jobs.limits import DEFAULT, Limits
from executive.mission.jobs.runner import Runner, Task
from executive.mission.record.samples import Samples
from executive.mission.tick_times import TickTimes

_EPSILON_S = 1e-9
_NO_PLUGIN = Plugin()  # what a leaf's own function belongs to

Arguments = ParamSpec("Arguments")
Value = TypeVar("Value")


class PluginJob(Job[Value]):
    """One call of a verb that has begun."""

    def __init__(
        self,
        task: Task,
        future: Future[Value],
        clock: Clock,
        ready_s: float | None,
        abandon: Callable[[Task, Future[Value]], None],
    ) -> None:
        self._task = task
        self._future = future
        self._abandon = abandon
        self._clock = clock
        self._ready_s = ready_s  # None: against the wall clock, ready when done

    def is_ready(self) -> bool:
        if self._ready_s is None:
            return self._future.done()
        return self._clock.now_s() >= self._ready_s - _EPSILON_S

    def result(self) -> Value:
        """Return what the verb returned, or raise what it raised.

        Raises:
            WrongAnswerError: If it returned something else than its interface says.
            CallError: If it came to no answer.
        """
        answer = self._future.result()
        reason = unfit(self._task.plugin, self._task.call.verb, answer)
        if reason:
            raise self._task.address.error(WrongAnswerError, f"it returned {reason}")
        return answer

    def cancel(self) -> None:
        if not self._future.cancel():
            self._abandon(self._task, self._future)


class Jobs:
    """Starts jobs, charges their latency, and measures their wall time for the report.

    Attributes:
        durations_ms: Wall time of each call, by `capability.verb` [ms].
        told: What happened to workers since the mission last took it.
    """

    def __init__(
        self,
        plugins: Mapping[str, Any],
        runner: Runner,
        clock: Clock,
        *,
        is_lock_step: bool,
        limits: Limits = DEFAULT,
        told: deque[WorkerReplaced] | None = None,
    ) -> None:
        self._plugins = plugins
        self._runner = runner
        self._clock = clock
        self._is_lock_step = is_lock_step
        self._limits = limits
        self.durations_ms: dict[str, Samples[float]] = {}
        self.told: deque[WorkerReplaced] = deque() if told is None else told
        self._memory: MemoryLimit | None = None
        # Which calls a fault on purpose lets fail; None without such faults.
        self.faults: Injector | None = None
        # What a tick spends on calls, which beside the tick is little more than to send them.
        self.times = TickTimes(measures=not is_lock_step)

    def prepare(self) -> None:
        """Limit the memory of this process; in real time, start workers and wait for them.

        No verb has to wait for the start of its worker then.

        Raises:
            Exception: What a plugin raises when it is made or started in a worker.
        """
        self._memory = MemoryLimit(self._limits.memory_bytes)
        if self._is_lock_step:
            return
        starting = [
            self._runner.prepare(capability)
            for capability, _, plugin in selected_plugins(self._plugins)
            if plugin.is_stateless and plugin.latency_s
        ]
        for one in starting:
            if one is not None:
                one.result()

    def start(
        self,
        verb: Callable[Arguments, Value],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> PluginJob[Value]:
        """Start a verb of a selected plugin, or a leaf's own function.

        Raises:
            ConfigError: If it is a method, and not one of one of the mission's plugins.
        """
        if inspect.isfunction(verb):
            task = self._function_task(FunctionCall(verb.__name__, args, dict(kwargs), verb))
        else:
            task = self._task(verb, VerbCall(verb.__name__, args, dict(kwargs)))
        name = task.call.verb
        started_s = wall_s()
        stage = f"{task.address.capability or 'leaf'}.{name}"
        with self.times.spent(stage):
            future = self._runner.submit(task)
        future.add_done_callback(lambda _: self._measure(stage, started_s))
        latency_s = task.plugin.latency_s.get(name, 0.0) + getattr(task.call, "charged_s", 0.0)
        ready_s = self._clock.now_s() + latency_s if self._is_lock_step else None
        return PluginJob(task, future, self._clock, ready_s, self._runner.abandon)

    def computes_beside(self, plugin: Plugin, verb: str) -> bool:
        """Return whether a thread beside the tick computes a verb of a plugin with state."""
        return not self._is_lock_step and verb in plugin.beside_tick

    def _task(self, verb: Callable[..., Any], call: VerbCall) -> Task:
        capability, name, plugin = self._plugin_of(verb)
        address = Address.of(capability, name, plugin, call.verb)
        if self.faults is not None and self.faults.is_aimed_at(capability, call.verb):
            fault = self.faults.decide(capability, call.verb)
            call = decided(call, fault, is_lock_step=self._is_lock_step)
        limit_s = self._limits.time_s(plugin, call.verb)
        return Task(address, plugin, call, limit_s, counts_computing=self._is_lock_step)

    def _function_task(self, call: FunctionCall) -> Task:
        address, limit_s = Address.of_function(call.function), self._limits.time_s(_NO_PLUGIN, "")
        return Task(address, _NO_PLUGIN, call, limit_s, counts_computing=self._is_lock_step)

    def _plugin_of(self, verb: Callable[..., Any]) -> tuple[str, str, Plugin]:
        owner = getattr(verb, "__self__", None)
        for capability, name, plugin in selected_plugins(self._plugins):
            if plugin is owner:
                return capability, name, plugin
        raise ConfigError(
            f"{getattr(verb, '__qualname__', verb)} is no method of a plugin of this mission; a "
            "job takes a verb of what `use` returns, or a function"
        )

    def _measure(self, stage: str, started_s: float) -> None:
        self.durations_ms.setdefault(stage, Samples()).append(1e3 * (wall_s() - started_s))

    def close(self) -> None:
        """End all runners, and release the limit of memory."""
        self._runner.close()
        if self._memory is not None:
            self._memory.release()
