"""How far odometry and fixes usually drift apart, as a share of the distance travelled."""

from collections import deque

import numpy as np

_WINDOWS = 10
_SIGMAS = 3.0
# A share that no odometry of use exceeds; it holds until there is a record.
_UNPROVEN = 0.1
_LEAST_WAY_M = 1.0  # over a shorter way, the drift of odometry is below the noise of fixes


class DriftRecord:
    """The drift over the newest windows that do not overlap, in which the body has moved.

    Odometry that has always drifted does not refute fixes by drifting.

    Attributes:
        share: Largest drift that the record explains, as a share of the distance travelled.
    """

    def __init__(self, window_s: float) -> None:
        """Make an empty record.

        Args:
            window_s: Length of a window [s].
        """
        self._window_s, self._newest_s = window_s, -np.inf
        self._shares: deque[float] = deque(maxlen=_WINDOWS)
        self.share = _UNPROVEN

    def add(self, stamp_s: float, drift_m: float, way_m: float) -> None:
        """Add a window, unless it overlaps the last one or the body hardly moved.

        Args:
            stamp_s: Its end [s].
            drift_m: Distance by which fixes and odometry drifted apart [m].
            way_m: Distance travelled [m].
        """
        if way_m < _LEAST_WAY_M or stamp_s - self._newest_s < self._window_s:
            return
        self._newest_s = stamp_s
        self._shares.append(drift_m / way_m)
        self.share = _SIGMAS * float(np.sqrt(np.mean(np.square(self._shares))))
