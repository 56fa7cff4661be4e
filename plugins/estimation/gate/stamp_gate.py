"""Check that stamps are in order; wrong samples are refused and counted, never repaired."""

import math
from collections import Counter

_JUMP_S = 5.0  # longer than the period of any stream
_SET_BACK_S = 1.0  # stamps that are behind but increase for so long: the clock was set back


class StampGate:
    """Accepts samples whose stamps increase, separately for each stream.

    A stamp far ahead is accepted only if the next one is close to it: a single wrong stamp would
    otherwise cause all later samples to be refused. The first stamp of a stream may be wrong as
    well; the second may therefore be far earlier. A clock that was set back is followed once its
    stamps have increased for a second with no stamp of the old clock among them.

    Attributes:
        refused: Number of refused samples by stream and reason, such as `imu_cabin: back in time`.
    """

    def __init__(self) -> None:
        self.refused: Counter[str] = Counter()
        self._newest_s: dict[str, float] = {}
        self._ahead_s: dict[str, float] = {}
        # For each stream: newest stamp of the old clock, first and last stamp of the new one.
        self._behind_s: dict[str, tuple[float, float, float]] = {}
        self._alone: set[str] = set()  # streams with one stamp only since the start or a jump

    def admits(self, stream: str, stamp_s: float, jump_s: float = _JUMP_S) -> bool:
        """Return whether a stamp is finite and newer than the stream's newest, and remember it.

        Args:
            stream: Name of the stream.
            stamp_s: Time of measurement [s].
            jump_s: A stamp that is newer by more than this is accepted only after a second one
                near it [s].
        """
        is_usual = stream not in self._alone and stream not in self._ahead_s
        if is_usual and 0 < stamp_s - self._newest_s.get(stream, math.inf) <= jump_s:
            self._newest_s[stream] = stamp_s  # fast path: most samples arrive in order
            return True
        reason = self._reason(stream, stamp_s, jump_s)
        if reason:
            self.refuse(stream, reason)
            return False
        (self._alone.discard if stream in self._newest_s else self._alone.add)(stream)
        self._newest_s[stream] = stamp_s
        self._ahead_s.pop(stream, None)
        return True

    def refuse(self, stream: str, reason: str) -> None:
        """Count a sample that was found wrong by another check."""
        self.refused[f"{stream}: {reason}"] += 1

    def _reason(self, stream: str, stamp_s: float, jump_s: float) -> str:
        newest_s = self._newest_s.get(stream, stamp_s - 0.5 * jump_s)
        if not math.isfinite(stamp_s):
            return "stamp not finite"
        if stamp_s == newest_s:
            return "duplicate"
        if stamp_s < newest_s:
            first_was_wrong = stream in self._alone and newest_s - stamp_s > jump_s
            return (
                ""
                if first_was_wrong or self._is_set_back(stream, stamp_s, newest_s, jump_s)
                else "back in time"
            )
        if stamp_s - newest_s <= jump_s:
            return ""
        before_s = self._ahead_s.get(stream, math.inf)
        self._ahead_s[stream] = stamp_s
        return "" if 0 < stamp_s - before_s <= jump_s else "ahead of time"

    def _is_set_back(self, stream: str, stamp_s: float, newest_s: float, jump_s: float) -> bool:
        """Return whether the clock was set back for good, and count that."""
        against_s, first_s, last_s = self._behind_s.get(stream, (math.nan, stamp_s, stamp_s))
        if against_s != newest_s or not 0 < stamp_s - last_s <= jump_s:
            first_s = stamp_s
        self._behind_s[stream] = (newest_s, first_s, stamp_s)
        if stamp_s - first_s < _SET_BACK_S:
            return False
        self.refuse(stream, "clock set back, followed")
        return True
