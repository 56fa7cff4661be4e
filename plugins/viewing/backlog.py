"""What a live viewer has not taken yet: bounded, because a viewer that hangs never takes it."""

import logging
import threading

import rerun as rr

_LOOK_S = 1.0  # between two looks whether the viewer takes what it is sent
_MOST_S = 2.0  # a viewer that is busy drawing takes it later by less than that

_log = logging.getLogger(__name__)


class Backlog:
    """Asks in a thread whether a viewer takes what it is sent; the mission never waits for it.

    Attributes:
        is_full: Whether the viewer has taken nothing for some seconds: what comes is to be dropped.
        dropped: Number of messages that were.
    """

    def __init__(self, stream: rr.RecordingStream, most_s: float = _MOST_S) -> None:
        self._stream, self._most_s = stream, most_s
        self._has_ended = threading.Event()
        self.is_full = False
        self.dropped = 0
        threading.Thread(target=self._watch, name="rerun-backlog", daemon=True).start()

    def drops(self) -> bool:
        """Return whether a message is to be dropped, and count it."""
        self.dropped += self.is_full
        return self.is_full

    def close(self) -> None:
        """Look no more; tell how much was dropped."""
        self._has_ended.set()
        if self.dropped:
            _log.warning("%d messages were not shown in the rerun viewer", self.dropped)

    def _watch(self) -> None:
        while not self._has_ended.wait(_LOOK_S):
            try:
                self._stream.flush(timeout_sec=self._most_s)
            except RuntimeError as error:  # it hangs, or is gone
                if not self.is_full:
                    told = "the rerun viewer takes nothing (%s): what comes is not shown"
                    _log.warning(told, str(error).splitlines()[0])
                self.is_full = True
            else:
                if self.is_full:
                    _log.warning("the rerun viewer takes messages again")
                self.is_full = False
