"""How far odometry and fixes usually drift apart, as a share of the distance travelled."""

from collections import deque

import numpy as np

_WINDOWS = 10
_SIGMAS = 3.0
# Before there is a record: odometry drifts by 1 % (one standard deviation), as by so many windows.
_USUAL, _USUAL_WINDOWS = 0.01, 3
_LEAST_WAY_M = 1.0  # over a shorter way, the drift of odometry is below the noise of fixes


class DriftRecord:
    """The drift over the newest windows that do not overlap, in which the body has moved.

    Odometry that has always drifted does not refute fixes by drifting. A window counts only once
    the one after it has passed, so that a drift that begins is not its own excuse.

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
        self._pending: float | None = None
        self.share = _SIGMAS * _USUAL

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
        if self._pending is not None:
            self._shares.append(self._pending)
        self._pending = drift_m / way_m
        squares = float(np.sum(np.square(self._shares))) + _USUAL_WINDOWS * _USUAL**2
        self.share = _SIGMAS * float(np.sqrt(squares / (len(self._shares) + _USUAL_WINDOWS)))
