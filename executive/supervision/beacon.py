"""A page of memory that the executive writes and its supervisor reads: signs of life.

The page outlives the process that wrote it. A field is written by one process alone; numbers are
aligned, so that a reader sees the old or the new one. A text is too long for that: its checksum is
written with it, and one that is half written is read again.
"""

import json
import mmap
import threading
import time
from collections.abc import Mapping
from typing import Any
from zlib import crc32

_NUMBER_BYTES = 8
_TEXT_BYTES = 4096
_CHECK_BYTES = 4
_LOOKS = 3  # at a text that is being written
_NUMBERS = ("beat_s", "limit_s", "verb_until_s", "ended", "joints_s", "joints_limit_s")
_TEXTS = ("activity", "loop", "run_dir", "machine", "stack", "mission")
_TEXTS_AT = _NUMBER_BYTES * len(_NUMBERS)
_NEVER_ENDED = -1.0


class Beacon:
    """Signs of life of one run.

    Times are those of the system's monotonic clock, which is the same for all processes [s]. A
    limit of 0 means that the supervisor does not watch it.
    """

    def __init__(self) -> None:
        self._page = mmap.mmap(-1, _TEXTS_AT + _TEXT_BYTES * len(_TEXTS))
        # An item of such a view is written in one piece; `struct.pack_into` writes zeros first,
        # and a supervisor that looked at that moment took the loop for silent since it started.
        self._numbers = memoryview(self._page)[:_TEXTS_AT].cast("d")
        self._computed: dict[int, tuple[float, str]] = {}  # until when, and what
        self._entered: list[bytes] = [_block("")]  # what the loop is in, the innermost last
        self._lock = threading.RLock()  # an alarm may ring while its thread holds it
        self._set("ended", _NEVER_ENDED)

    # --- what the executive writes

    def watch(self, limit_s: float, joints_limit_s: float) -> None:
        """From now on a loop that gives no sign for so long, or has no joint sample, is stopped."""
        self.beat()
        self._set("joints_s", time.monotonic())
        self._set("joints_limit_s", joints_limit_s)
        self._set("limit_s", limit_s)

    def unwatch(self) -> None:
        """The loop has ended: nothing is stopped for silence any more."""
        self._set("limit_s", 0.0)

    def beat(self) -> None:
        """Give a sign of life: once a tick."""
        self._set("beat_s", time.monotonic())

    def see_joints(self) -> None:
        """Note that a joint sample has arrived."""
        self._set("joints_s", time.monotonic())

    def begin(self, key: int, activity: Mapping[str, str], limit_s: float) -> None:
        """Note what is computed in the executive's own process, and how long it may take.

        Several threads may compute at a time. What has to end first is what is noted.

        Args:
            key: By which `end` finds it.
            activity: What is computed.
            limit_s: How long it may take from now on [s].
        """
        with self._lock:
            self._computed[key] = time.monotonic() + limit_s, json.dumps(activity)
            self._note_the_first()

    def extend(self, key: int, limit_s: float) -> None:
        """Note that a computation may take longer: `limit_s` from now on [s]."""
        with self._lock:
            if key in self._computed:
                self._computed[key] = time.monotonic() + limit_s, self._computed[key][1]
                self._note_the_first()

    def end(self, key: int) -> None:
        """Note that a computation has ended; one that has ended already is no mistake."""
        with self._lock:
            self._computed.pop(key, None)
            self._note_the_first()

    def enter(self, note: bytes) -> None:
        """Note what the loop's thread goes into, as `note_of` returns it; it may be within another.

        It is called some hundred times a tick, and takes less than a microsecond.
        """
        self._entered.append(note)
        self._put("loop", note)

    def leave(self) -> None:
        """Note that the loop's thread has come out of what it went into last."""
        self._entered.pop()
        self._put("loop", self._entered[-1])

    def _note_the_first(self) -> None:
        until_s, activity = min(self._computed.values(), default=(0.0, ""))
        self._write("activity", activity)
        self._set("verb_until_s", until_s)

    def name(self, **texts: str) -> None:
        """Note `run_dir`, `mission`, the address of the `machine`, or the file of the `stack`."""
        for field, text in texts.items():
            self._write(field, text)

    def finish(self, status: int) -> None:
        """Note that the run is over, with its exit status; without this note it was cut off."""
        self.unwatch()
        self._set("ended", float(status))

    # --- what the supervisor reads

    def silent_s(self, since_s: float = 0.0) -> float:
        """Return how long the loop has been silent beyond what it may [s]; 0 if it has not.

        Args:
            since_s: Time before which silence does not count [s].
        """
        silent_s = time.monotonic() - max(self._get("beat_s"), since_s)
        return silent_s if 0 < self._get("limit_s") < silent_s else 0.0

    def joints_age_s(self, since_s: float = 0.0) -> float:
        """Return the age of the newest joint sample [s] if it is too old; else 0.

        Args:
            since_s: Time before which no sample is missed [s].
        """
        if not self._get("limit_s"):
            return 0.0
        age_s = time.monotonic() - max(self._get("joints_s"), since_s)
        return age_s if 0 < self._get("joints_limit_s") < age_s else 0.0

    def is_computing(self) -> bool:
        """Return whether a verb is computed in the executive's process, which has its own limit."""
        return self._get("verb_until_s") > 0.0

    def overdue_s(self) -> float:
        """Return how long ago a verb in the executive's process should have ended [s]; else 0."""
        until_s = self._get("verb_until_s")
        return max(time.monotonic() - until_s, 0.0) if until_s else 0.0

    def status(self) -> int | None:
        """Return the exit status of a run that ended in order; None of one that has not."""
        ended = self._get("ended")
        return None if ended == _NEVER_ENDED else int(ended)

    def activity(self) -> Mapping[str, Any]:
        """Return what was computed: component, capability, name, verb, place, package folder."""
        return self._activity("activity")

    def loop(self) -> Mapping[str, Any]:
        """Return what the loop's thread was in: the same of a plugin's verb, or that of a node."""
        return self._activity("loop")

    def _activity(self, field: str) -> Mapping[str, Any]:
        try:
            found = json.loads(self.text(field) or "{}")
        except ValueError:  # it was cut off in the middle of the note
            return {}
        return found if isinstance(found, dict) else {}

    def forget(self) -> None:
        """Watch nothing any more; what was computed stays known."""
        self.unwatch()
        self._set("verb_until_s", 0.0)

    def text(self, field: str) -> str:
        """Return one of the texts; empty if it was not written, or only by a half."""
        start = _TEXTS_AT + _TEXT_BYTES * _TEXTS.index(field)
        for _ in range(_LOOKS):
            whole = self._page[start : start + _TEXT_BYTES]
            raw = whole[_CHECK_BYTES:].rstrip(b"\0")
            if whole[:_CHECK_BYTES] == _check(raw):
                return raw.decode(errors="replace")
        return ""

    def _write(self, field: str, text: str) -> None:
        self._put(field, _block(text))

    def _put(self, field: str, block: bytes) -> None:
        start = _TEXTS_AT + _TEXT_BYTES * _TEXTS.index(field)
        self._page[start : start + _TEXT_BYTES] = block

    def _set(self, field: str, value: float) -> None:
        self._numbers[_NUMBERS.index(field)] = value

    def _get(self, field: str) -> float:
        return self._numbers[_NUMBERS.index(field)]


def note_of(activity: Mapping[str, str]) -> bytes:
    """Return what `Beacon.enter` takes; it is worth keeping for the next time."""
    return _block(json.dumps(activity))


def _block(text: str) -> bytes:
    """Return a text as the page holds it."""
    raw = text.replace("\0", "").encode()[: _TEXT_BYTES - _CHECK_BYTES]
    return (_check(raw) + raw).ljust(_TEXT_BYTES, b"\0")


def _check(raw: bytes) -> bytes:
    """Return the checksum of a text; that of an empty one is zero, as a new page is."""
    return crc32(raw).to_bytes(_CHECK_BYTES, "little")


_inherited: list[Beacon] = []


def beacon() -> Beacon:
    """Return the page that the supervisor of this process reads; without one, a page nobody reads.

    It belongs to the process, as its exit status does: there is one run in a supervised process.
    """
    if not _inherited:
        _inherited.append(Beacon())
    return _inherited[0]


def inherit(found: Beacon) -> None:
    """Make a page the one of this process."""
    _inherited[:] = [found]
