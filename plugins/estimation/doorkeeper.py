"""The door of an estimator: samples that cannot be right are refused and counted, never repaired."""

import math
from collections import Counter


class Doorkeeper:
    """Admits samples whose stamps rise, one stream at a time.

    Attributes:
        refused: Number of refused samples by reason, such as `imu_cabin: back in time`.
    """

    def __init__(self) -> None:
        self.refused: Counter[str] = Counter()
        self._newest_s: dict[str, float] = {}

    def admits(self, stream: str, stamp_s: float) -> bool:
        """Return whether a stamp is finite and newer than the stream's newest, and remember it."""
        reason = self._reason(self._newest_s.get(stream, -math.inf), stamp_s)
        if reason:
            self.refuse(stream, reason)
            return False
        self._newest_s[stream] = stamp_s
        return True

    def refuse(self, stream: str, reason: str) -> None:
        """Count a sample that somebody else found wrong."""
        self.refused[f"{stream}: {reason}"] += 1

    @staticmethod
    def _reason(newest_s: float, stamp_s: float) -> str:
        if not math.isfinite(stamp_s):
            return "stamp not finite"
        if stamp_s == newest_s:
            return "duplicate"
        return "back in time" if stamp_s < newest_s else ""
