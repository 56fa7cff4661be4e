"""The door for streams whose samples may come late and out of order."""

import math
from collections import deque

from executive_plugins.estimation.gate.stamp_gate import StampGate

_REMEMBERED = 1000  # stamps a stream: 50 s of fixes
_AHEAD_S = 1.0  # no sensor is so much earlier than the inertial one


class UnorderedStampGate:
    """Admits each stamp once, and none that the inertial samples cannot reach; refusals are the
    doorkeeper's.
    """

    def __init__(self, door: StampGate) -> None:
        self._stamp_gate = door
        self._seen: dict[str, deque[float]] = {}

    def admits(self, stream: str, stamp_s: float, now_s: float) -> bool:
        """Return whether a stamp is new, finite and not in the future of the newest inertial
        sample.
        """
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
