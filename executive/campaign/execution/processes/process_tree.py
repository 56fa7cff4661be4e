"""The processes of a run: its own, and all that descend from it."""

import os
import signal
from contextlib import suppress
from pathlib import Path

import psutil


class ProcessTree:
    """A process, the leader of its session, with its descendants, also those of other sessions."""

    def __init__(self, pid: int) -> None:
        self._pid = pid
        self._known: dict[int, psutil.Process] = {}
        with suppress(psutil.NoSuchProcess):
            self._known[pid] = psutil.Process(pid)

    def resident_bytes(self) -> int:
        """Return the resident memory of all its processes together [byte]; 0 if all have ended."""
        self._look()
        used = 0
        for process in tuple(self._known.values()):
            try:
                used += process.memory_info().rss
            except psutil.Error:
                del self._known[process.pid]
        return used

    def kill(self) -> None:
        """End them all at once, and those that have been seen at an earlier look."""
        self._look()
        leader = self._known.get(self._pid)
        if leader is not None and leader.is_running():  # else the number may be another's
            with suppress(OSError):
                os.killpg(self._pid, signal.SIGKILL)
        for process in self._known.values():
            with suppress(psutil.Error):
                process.kill()  # psutil compares the start, so that it kills no successor

    def _look(self) -> None:
        """Find descendants that are new; those of a parent that has ended are known from before."""
        pending = [process.pid for process in self._known.values()]
        while pending:
            for pid in _children_of(pending.pop()):
                if pid not in self._known:
                    with suppress(psutil.NoSuchProcess):
                        self._known[pid] = psutil.Process(pid)
                        pending.append(pid)


def _children_of(pid: int) -> list[int]:
    """Return the children of a process; on Linux without reading every process of the computer."""
    found: list[int] = []
    try:
        for task in Path(f"/proc/{pid}/task").iterdir():
            found += map(int, (task / "children").read_text().split())
    except OSError:  # it has ended, or this is another system
        with suppress(psutil.Error):
            if not Path("/proc/self/task").exists():
                found = [child.pid for child in psutil.Process(pid).children()]
    return found
