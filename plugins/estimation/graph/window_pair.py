"""A graph beside a second one, of which one uses odometry and the other does not."""

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.odometry_trial import COMPARED
from executive_plugins.estimation.graph.fix_comparison import predicted
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.inertial.noise import InertialNoise

from executive.geometry.rotation import log_so3

_FIX = "fix"


class WindowPair:
    """The graph that is reported, and another that differs from it by the odometry alone.

    Attributes:
        main: The first graph.
        other: The second; None until there is odometry.
    """

    def __init__(self, main: GraphWindow, noise: InertialNoise) -> None:
        self.main, self._noise = main, noise
        self.other: GraphWindow | None = None

    @property
    def stamp_s(self) -> float:
        """Time of the first graph's newest node [s]."""
        return self.main.newest_s

    @property
    def both(self) -> tuple[GraphWindow, ...]:
        """The graphs that there are."""
        return (self.main,) if self.other is None else (self.main, self.other)

    def add_fix(self, fix: Fix) -> None:
        """Add a fix to both."""
        for window in self.both:
            if fix.stamp_s > window.oldest_s:
                window.add(_FIX, fix.stamp_s, [window.factor_of(fix)])

    def take_back_fixes(self, after_s: float) -> None:
        """Remove the fixes that are newer than a time [s]."""
        for window in self.both:
            window.take_back(_FIX, after_s)

    def renew_other(self) -> None:
        """Let the second graph be as the first is."""
        self.other = self.main.copy()

    def drop_other(self) -> None:
        """Forget the second graph."""
        self.other = None

    def exchange(self) -> None:
        """Let each graph be the other one."""
        if self.other is not None:
            self.main, self.other = self.other, self.main

    def separation2(self) -> float:
        """Return the squared distance of both; see `WitnessedFilter.separation2`."""
        if self.other is None:
            return 0.0
        at_s = max(self.main.newest_s, self.other.newest_s)
        (one, P_one), (two, P_two) = (predicted(w, at_s, self._noise) for w in self.both)
        turn = log_so3(one.R_map_imu.T @ two.R_map_imu)
        apart = [turn, two.v_map_imu - one.v_map_imu, two.p_map_imu - one.p_map_imu]
        P = max(P_one, P_two, key=lambda P: float(np.trace(P[:COMPARED, :COMPARED])))
        return squared_distance(P[:COMPARED, :COMPARED], np.concatenate(apart))
