"""What is known of a run that was cut off, and how its mission goes on from there."""

import os
from dataclasses import dataclass

from py_trees.behaviour import Behaviour

from executive.clock import Clock
from executive.errors import ConfigError
from executive.events.mission import MissionEnded, Resumed
from executive.events.node import LeafAnswered, LeafCalled, NodeEnded
from executive.journal import Entry, Journal, JournalFile
from executive.journal.value_folder import ValueFolder
from executive.mission.record.account import Account
from executive.mission.record.history import History
from executive.mission.record.keeper import Instant
from executive.mission.record.leaf_memory import LeafMemory
from executive.mission.run_folder import RunFolder
from executive.tree.modifiers import RetryNode
from executive.tree.repeating import RepeatingNode


class PastClock(Clock):
    """Shows the time of the tick that is followed."""

    def __init__(self, history: History) -> None:
        super().__init__()
        self._history = history

    def now_s(self) -> float:
        return self._history.time_s

    def machine_s(self) -> float:
        return self._history.time_s

    def go_on_at(self, tick: int, tick_s: float, now_s: float, machine_s: float) -> None:
        """Do nothing: the history says which tick comes next."""

    def advance(self, dt_s: float) -> float:
        """Return 0: the history says which tick comes next."""
        return 0.0

    def idle(self) -> None:
        """Do nothing: the past is followed as fast as it can be read."""


@dataclass(frozen=True, slots=True)
class Resumption:
    """A run that was cut off, as its folder holds it.

    Attributes:
        folder: The run's folder, whose lock this process holds.
        entries: All entries of its journal.
        cut_off_bytes: Length of a last line that was left out [byte].
        checksum: Checksum of the last entry.
        history: The tree's past.
    """

    folder: RunFolder
    entries: tuple[Entry, ...]
    cut_off_bytes: int
    checksum: str
    history: History

    @classmethod
    def read(cls, folder: RunFolder) -> "Resumption":
        """Read a run's folder, and take a last line that was cut off out of its journal.

        Raises:
            ConfigError: If its mission has ended.
            DataError: If the journal is damaged before its last line; it names the line.
        """
        file = JournalFile(folder.journal)
        entries = tuple(file.entries())
        ended = next((e.event for e in entries if isinstance(e.event, MissionEnded)), None)
        if isinstance(ended, MissionEnded):
            raise ConfigError(
                f"{folder.path}: the mission has ended ({ended.outcome}); there is nothing to "
                "resume"
            )
        if file.cut_off:
            os.truncate(folder.journal, file.whole_bytes)
        history = History(entries, ValueFolder(folder.values))
        return cls(folder, entries, file.cut_off, file.checksum, history)

    def write_after(self, journal: Journal, account: Account) -> None:
        """Let a journal and an account go on after the past."""
        for entry in self.entries:
            account.add(entry)
        if self.entries:
            journal.go_on_after(self.entries[-1], self.checksum)

    def follow(self, root: Behaviour, memory: LeafMemory) -> None:
        """Tick a new tree through the past.

        Raises:
            DataError: If it does something else than it did.
        """
        nodes = list(root.iterate())
        counts = (RepeatingNode, RetryNode)
        every_tick = any(node.is_repeated and isinstance(node, counts) for node in nodes)

        def tick() -> None:
            memory.begin_tick(self.history.tick)
            root.tick_once()

        self.history.follow(tick, every_tick=every_tick)

    def instant(self, kept: Instant | None, tick_s: float) -> Instant:
        """Return when the mission goes on: where the machine's state was kept, and not before the
        journal's end.
        """
        last = self.entries[-1] if self.entries else None
        ended_tick, ended_s = (last.tick, last.time_s) if last else (0, 0.0)
        if kept is not None and kept.tick >= ended_tick:
            return kept
        machine_s = kept.machine_s - kept.mission_s if kept else 0.0
        return Instant(ended_tick + 1, ended_s + tick_s, ended_s + tick_s + machine_s)

    def event(self, restored: tuple[str, ...], not_restored: tuple[str, ...]) -> Resumed:
        """Return what the journal says of it."""
        return Resumed(
            lines=len(self.entries),
            cut_off_bytes=self.cut_off_bytes,
            restored=restored,
            not_restored=not_restored,
            under_way=tuple(sorted(_under_way(self.entries))),
        )


def _under_way(entries: tuple[Entry, ...]) -> set[str]:
    """Return the nodes of the actions that had begun and not ended."""
    found: set[str] = set()
    for entry in entries:
        if isinstance(entry.event, LeafCalled):
            found.add(entry.node)
        elif isinstance(entry.event, LeafAnswered | NodeEnded):
            found.discard(entry.node)
    return found
