"""Which runner a mission has: what the command line or its file says, else by its clock."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from executive.clock import Clock
from executive.errors import ConfigError
from executive.events.mission import WorkerReplaced
from executive.mission.assembly import Selections
from executive.mission.jobs.jobs import Jobs
from executive.mission.jobs.limits import Limits
from executive.mission.jobs.process_runner import ProcessRunner
from executive.mission.jobs.runner import InlineRunner, Runner
from executive.mission.jobs.thread_runner import ThreadRunner
from executive.tree.loop_settings import LoopSettings


@dataclass(frozen=True, slots=True)
class Choice:
    """What runners are made of.

    Attributes:
        plugins: The mission's plugins by capability.
        selections: What they were made from; a worker process makes its own copies.
        model: Name or folder of the machine.
        seed: Seed of the mission.
    """

    plugins: Mapping[str, Any]
    selections: Selections
    model: str
    seed: int

    def make(
        self, loop: LoopSettings, clock: Clock, asked: str | None, *, is_lock_step: bool
    ) -> Jobs:
        """Return the jobs of a mission.

        In lock-step, verbs are computed inline by default, which costs no process; in real time in
        worker processes, which can be ended.

        Raises:
            ConfigError: If verbs are to be computed in the tick of the wall clock.
        """
        limits, told = Limits.of(loop.jobs), deque[WorkerReplaced]()
        runners: dict[str, Callable[[], Runner]] = {
            "inline": InlineRunner,
            "thread": ThreadRunner,
            "process": lambda: ProcessRunner(
                self.selections, self.model, self.seed, limits, told.append
            ),
        }
        name = asked or loop.runner or ("inline" if is_lock_step else "process")
        if name == "inline" and not is_lock_step:
            raise ConfigError(
                "on the wall clock no verb is computed in the tick, which it would delay: choose "
                "the runner process or thread, or leave --real-time out"
            )
        return Jobs(
            self.plugins,
            runners[name](),
            clock,
            is_lock_step=is_lock_step,
            limits=limits,
            told=told,
        )
