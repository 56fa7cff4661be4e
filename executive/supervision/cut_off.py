"""A run that was cut off: why, where, and the report that it could not write itself."""

import contextlib
import json
import re
import signal
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from executive.supervision.beacon import Beacon

_LINE = re.compile(r'^  File "(?P<file>.+)", line (?P<line>\d+) in (?P<verb>\S+)', re.M)


class CutOff:
    """What is known of an executive's process that ended without an exit status of its own.

    Attributes:
        reason: One line for a person: plugin, verb, what happened, file and line.
    """

    def __init__(self, beacon: Beacon, code: int, stopped: str) -> None:
        self._beacon = beacon
        self._stack = self._left()
        loop, job = beacon.loop(), beacon.activity()
        self._activity = job or loop  # of a job that is computed in the loop, that is the inner one
        how = stopped or f"the executive's process {_ending(code)}"
        place = self._place()
        at = f" ({place})" if place else ""
        self._error = how
        self.reason = f"{_who(self._activity)}{how}{at}{_beside(loop, self._activity)}"

    def write_report(self) -> None:
        """Write what is known as the run's report, unless there is one."""
        folder = self._beacon.text("run_dir")
        path = Path(folder) / "report.json"
        if not folder or path.exists():
            return
        with contextlib.suppress(OSError):
            path.write_text(json.dumps(self._report(), indent=2) + "\n", encoding="utf-8")

    def _report(self) -> dict[str, Any]:
        """Return a `CutOffReport` (executive.interfaces.report) as JSON holds it.

        The supervisor's process imports nothing heavy, such as that class with its arrays: a test
        reads what is written here as that class.
        """
        return {
            "mission": self._beacon.text("mission"),
            "outcome": "fault",
            "reason": self.reason,
            "fault": {
                "component": self._activity.get("component", "the mission"),
                "capability": self._activity.get("capability", ""),
                "name": self._activity.get("name", ""),
                "verb": self._activity.get("verb", ""),
                "node": self._activity.get("node", ""),
                "error": self._error,
                "place": self._place(),
                "traceback": self._stack,
            },
        }

    def _place(self) -> str:
        """Return `file:line` in the plugin's package, else of the innermost call that is known."""
        found = [(one["file"], one["line"]) for one in _LINE.finditer(self._stack)]
        folder = self._activity.get("folder", "")
        own = [one for one in found if folder and one[0].startswith(folder)]
        if not found or (folder and not own):
            return str(self._activity.get("place", ""))
        file, line = (own or found)[0]
        return f"{file}:{line}"

    def _left(self) -> str:
        path = Path(self._beacon.text("stack") or "/nonexistent")
        try:
            text = path.read_text(encoding="utf-8", errors="replace")
            path.unlink()
        except OSError:
            return ""
        return text


def _who(activity: Mapping[str, str]) -> str:
    verb = f" in '{activity['verb']}'" if activity.get("verb") else ""
    return f"{activity['component']} failed{verb}: " if activity.get("component") else ""


def _beside(loop: Mapping[str, str], told: Mapping[str, str]) -> str:
    """Say where the loop was while a thread computed: nothing tells which of them ended both."""
    return "" if loop in ({}, told) else f"; the loop was in {_named(loop)}"


def _named(activity: Mapping[str, str]) -> str:
    verb = f"'{activity['verb']}' of " if activity.get("verb") else ""
    return f"{verb}{activity.get('component', '')}"


def _ending(code: int) -> str:
    if code < 0:
        return f"was ended by {signal.Signals(-code).name}"
    return f"ended with exit status {code} before its run was over"
