"""A dry run: the tree of a mission is ticked with mocked leaves, and time passes without waiting.

A tick in which nothing happened is followed by the next one at which something can: the end of a
mocked action, of a `wait`, of a `timeout`. So an hour of a mission takes milliseconds, and the
journal is the same as if every tick had been computed.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from py_trees.common import Status

from executive.coverage.coverage import Tally
from executive.dry_run.chance import Chance
from executive.dry_run.mocked_leaf import EPSILON_S
from executive.dry_run.runtime import DryRuntime
from executive.dry_run.script import Script
from executive.events.mission import MissionEnded
from executive.events.node import NodeEnded
from executive.journal import Entry, Journal
from executive.leaf.store import Store
from executive.tree.build import build_tree, halt
from executive.tree.language import MissionFile

_MOST_ENTRIES = 50_000  # of the journal: a busy hour has some thousands


@dataclass(frozen=True, slots=True)
class DryOptions:
    """How a mission is run dry.

    Attributes:
        chance: The probabilities of what no file says.
        script: What a file says.
        preset: What `--answer` says to a question with these choices; None if nothing.
        computes_each_tick: Pass over no tick: slow, and with the same journal.
    """

    chance: Chance = field(default_factory=Chance)
    script: Script = field(default_factory=Script)
    preset: Callable[[Sequence[str]], bool | str | None] = lambda choices: None
    computes_each_tick: bool = False


@dataclass(frozen=True, slots=True)
class DryResult:
    """What a dry run has shown.

    Attributes:
        outcome: `success` or `failure`.
        reason: Why it failed.
        ended_s: The mission's time at its end [s].
        tally: The branches that it has taken.
        ends: How nodes ended, in order: path and `success`, `failure`, `skipped` or `halted`.
        store: The keys of `main` at the end.
        made_up: Outputs that were made up, and fields of objects that were read, with one value.
    """

    outcome: str
    reason: str
    ended_s: float
    tally: Tally
    ends: Sequence[tuple[str, str]]
    store: Store
    made_up: dict[str, Any]


class DryRun:
    """One mission, run dry once."""

    def __init__(
        self, mission: MissionFile, options: DryOptions, journal: Journal | None = None
    ) -> None:
        self._mission, self._options = mission, options
        self._journal = journal or Journal()
        self._tally, self._ends = Tally(), list[tuple[str, str]]()
        self._made_up: dict[str, Any] = {}
        self._journal.follow(self._tally)
        self._journal.follow(self._follow)
        self._runtime = DryRuntime(
            self._journal,
            options.chance,
            options.script,
            options.preset,
            self._made_up.setdefault,
        )
        self._root = build_tree(mission, self._runtime)
        self._runtime.heed(self._root)

    def run(self) -> DryResult:
        """Tick until the tree has ended, or the mission's time limit has passed."""
        tick = 0
        try:
            while not (end := self._end_after(tick)):
                tick = self._next_tick(tick)
                dt_s = self._mission.loop.tick
                self._runtime.clock.go_on_at(tick, dt_s, tick * dt_s, tick * dt_s)
        finally:
            halt(self._root)
        outcome, reason = end
        self._runtime.record("", MissionEnded(outcome, reason))
        runtime = self._runtime
        return DryResult(
            outcome,
            reason,
            round(runtime.clock.now_s(), 9),
            self._tally,
            self._ends,
            runtime.store,
            self._made_up,
        )

    def _end_after(self, tick: int) -> tuple[str, str] | None:
        """Compute a tick; return the outcome of the mission and its reason if it has ended."""
        self._runtime.begin_tick(tick)
        self._root.tick_once()
        if self._root.status is Status.SUCCESS:
            return "success", ""
        if self._root.status is Status.FAILURE:
            return "failure", self._root.feedback_message
        limit_s = self._mission.loop.time_limit
        if self._runtime.clock.now_s() >= limit_s - EPSILON_S:
            return "failure", f"the time limit of {limit_s:.0f} s has passed; {self._running()}"
        if self._journal.length > _MOST_ENTRIES:
            told = f"after {_MOST_ENTRIES} entries of the journal, at a loop that takes no time?"
            return "failure", f"the dry run was ended {told} {self._running()}"
        return None

    def _running(self) -> str:
        """Say which nodes without children run."""
        leaves = [
            node.path
            for node in self._root.iterate()
            if node.status is Status.RUNNING and not node.children
        ]
        return f"running: {', '.join(leaves)}" if leaves else "nothing was running"

    def _next_tick(self, tick: int) -> int:
        """Return the next tick that is computed: the one before something can happen.

        A node that is cancelled then says how far it was one tick before, as in a real run.
        """
        if self._runtime.is_active or self._options.computes_each_tick:
            return tick + 1
        dt_s, limit_s = self._mission.loop.tick, self._mission.loop.time_limit
        due_s = self._runtime.next_due_s()
        until_s = limit_s if due_s is None else min(due_s, limit_s)
        found = max(tick, math.ceil((until_s - EPSILON_S) / dt_s) - 1)
        while found * dt_s < until_s - EPSILON_S:
            found += 1
        return max(tick + 1, found - 1)

    def _follow(self, entry: Entry) -> None:
        if isinstance(entry.event, NodeEnded):
            self._ends.append((entry.node, entry.event.status.value))
