"""The state of plugins, kept in the run's folder as the mission goes on, for resuming it."""

from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.errors import DataError
from executive.events.mission import Fault
from executive.interfaces.plugin import Plugin
from executive.journal.newest_file import NewestFile, newest_in
from executive.journal.value_file import from_bytes, to_bytes
from executive.mission.assembly import selected_plugins

_PERIOD_S = 5.0  # of what changes all the time, such as a map while the lidars scan
_MACHINE = "machine"


def folder_fault(error: OSError) -> Fault:
    """Return what ends a mission whose folder can no longer be written, such as on a full disk."""
    told = f"{error.strerror or error}: the run's folder cannot be written, so the mission ends"
    return Fault("the run's folder", "", "", "", "", told, "", "")


@dataclass(frozen=True, slots=True)
class Instant:
    """When the machine's state was kept.

    Attributes:
        tick: Number of the tick that was to come.
        mission_s: The mission's time [s].
        machine_s: The machine's time, which its stamps are given in [s].
    """

    tick: int
    mission_s: float
    machine_s: float


class Keeper:
    """Writes what plugins `keep`, each into a file of its own, whole or not at all.

    The robot's is written at each tick, because a simulated world lives in this process; the time
    is beside it. A robot that keeps nothing, because it lives elsewhere, has the time alone. The
    others' are written when a leaf has ended that may have changed them, and every few seconds. On
    the wall clock a thread writes those: a map is tens of megabytes, and a busy disk takes seconds.
    """

    def __init__(self, folder: Path, plugins: Mapping[str, Any], *, beside: bool = False) -> None:
        """Keep the state of plugins.

        Args:
            folder: Where it is kept.
            plugins: The mission's plugins by capability.
            beside: Whether a thread writes it, but for the machine's.
        """
        self._folder = folder
        self._thread = ThreadPoolExecutor(1, "keeper") if beside else None
        self._pending: dict[str, Future[None]] = {}
        self._is_owed = False  # something has changed while it was being written
        self._robot: Plugin = plugins["robot"]
        self._others = [
            (f"{capability}-{name}", plugin)
            for capability, name, plugin in selected_plugins(plugins)
            if plugin is not self._robot and type(plugin).keep is not Plugin.keep
        ]
        self._silent = [
            capability
            for capability, _, plugin in selected_plugins(plugins)
            if not plugin.is_stateless and type(plugin).keep is Plugin.keep
        ]
        self._machine: NewestFile | None = None
        self._written = dict.fromkeys((name for name, _ in self._others), 0)
        self._written_s = 0.0
        self.failure: OSError | None = None

    def keep(self, instant: Instant, *, leaf_ended: bool) -> None:
        """Write what has changed; called at the end of each tick."""
        if self.failure is not None:
            return
        try:
            self._take_ended()
            self._keep_machine({"at": instant, "state": self._robot.keep()})
            is_due = leaf_ended or instant.machine_s - self._written_s >= _PERIOD_S
            if is_due or (self._is_owed and not self._pending):
                self._written_s = instant.machine_s
                self._keep_others()
        except OSError as error:
            self.failure = error

    def restore(self) -> tuple[Instant | None, tuple[str, ...], tuple[str, ...]]:
        """Give the plugins back what they kept.

        Returns:
            When the machine's state was kept, if it was; capabilities whose state was taken back;
            and those of plugins with a state that keep nothing, or whose state was lost.
        """
        restored: list[str] = []
        lost = list(self._silent)
        for name, plugin in self._others:
            kept = self._read(name)
            if kept is not None:
                plugin.restore(kept)
            (lost if kept is None else restored).append(name.partition("-")[0])
        machine = _value_of(newest_in(self._folder / _MACHINE))
        if machine is None:
            return None, tuple(restored), ("robot", *lost)
        if machine["state"]:
            self._robot.restore(machine["state"])
            restored.insert(0, "robot")
        return machine["at"], tuple(restored), tuple(lost)

    def settle(self) -> None:
        """Wait until what was begun is written; the plugins are asked no more.

        Raises:
            Exception: What a plugin raises when it is asked for its state.
        """
        if self._thread is not None:
            self._thread.shutdown()
        try:
            self._take_ended()
        except OSError as error:
            self.failure = error

    def close(self) -> None:
        """Close the file of the robot's state."""
        if self._thread is not None:
            self._thread.shutdown()
        if self._machine is not None:
            self._machine.close()

    def _keep_machine(self, value: Any) -> None:
        if self._machine is None:
            self._folder.mkdir(exist_ok=True)
            self._machine = NewestFile(self._folder / _MACHINE)
        self._machine.write(to_bytes(value))

    def _keep_others(self) -> None:
        self._is_owed = False
        for name, plugin in self._others:
            revision = plugin.revision
            if revision == self._written[name]:
                continue
            if name in self._pending:
                self._is_owed = True
                continue
            self._written[name] = revision
            if self._thread is None:
                self._write(name, plugin.keep)
            else:
                kept = plugin.keep if "keep" in plugin.beside_tick else _constant(plugin.keep())
                self._pending[name] = self._thread.submit(self._write, name, kept)

    def _take_ended(self) -> None:
        """Forget what the thread has written, and raise what it met."""
        for name in [name for name, future in self._pending.items() if future.done()]:
            self._pending.pop(name).result()

    def _write(self, name: str, keep: Callable[[], Any]) -> None:
        path, value = self._folder / name, keep()
        partial = path.with_suffix(".partial")
        self._folder.mkdir(exist_ok=True)
        partial.write_bytes(to_bytes(value))
        partial.replace(path)

    def _read(self, name: str) -> Any:
        try:
            return _value_of((self._folder / name).read_bytes())
        except OSError:
            return None


def _constant(value: Any) -> Callable[[], Any]:
    return lambda: value


def _value_of(data: bytes | None) -> Any:
    """Return a value from its bytes; None if there are none, or they are damaged."""
    try:
        return None if data is None else from_bytes(data)
    except DataError:
        return None
