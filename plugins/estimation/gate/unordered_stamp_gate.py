"""Check of stamps for streams whose samples may arrive late and out of order."""

import math
from collections import deque

from executive_plugins.estimation.gate.stamp_gate import StampGate

_REMEMBERED = 1000  # stamps in each stream: 50 s of fixes at 20 Hz
_AHEAD_S = 1.0  # the inertial samples lag behind other sensors by less than this


class UnorderedStampGate:
    """Accepts each stamp once, unless it is in the future of the newest inertial sample.

    Refusals are counted by the `StampGate` that it is made with.
    """

    def __init__(self, stamp_gate: StampGate) -> None:
        self._stamp_gate = stamp_gate
        self._seen: dict[str, deque[float]] = {}

    def admits(self, stream: str, stamp_s: float, now_s: float) -> bool:
        """Return whether a stamp is new, finite and not later than `now_s` by a second."""
        seen = self._seen.setdefault(stream, deque(maxlen=_REMEMBERED))
        if not math.isfinite(stamp_s):
            reason = "stamp not finite"
        elif stamp_s in seen:
            reason = "duplicate"
        elif stamp_s > now_s + _AHEAD_S:
            reason = "ahead of time"
        else:
            seen.append(stamp_s)
            return True
        self._stamp_gate.refuse(stream, reason)
        return False
