"""Odometry in the main graph, or in a second one beside it once it has failed."""

from dataclasses import replace

import numpy as np
from executive_plugins.estimation.factors import between_factor
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm
from executive_plugins.estimation.gate.measurements import Fix, Increment
from executive_plugins.estimation.gate.odometry_trial import OdometryTrial, drift2
from executive_plugins.estimation.graph.fix_comparison import compared
from executive_plugins.estimation.graph.increment_check import IncrementCheck
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.graph.window_pair import WindowPair
from executive_plugins.estimation.inertial.noise import InertialNoise


class OdometryUse:
    """Adds increments to one of two graphs, and reports the one that they have not misled.

    The second graph exists only while there are odometry and fixes that agree with the estimate:
    it takes the smoother's time a second time.

    Attributes:
        pair: The graph that is reported, and the second one.
    """

    pair: WindowPair

    def __init__(
        self, settings: SmootherSettings, noise: InertialNoise, window: GraphWindow
    ) -> None:
        self._settings, self._noise = settings, noise
        self._increments = IncrementCheck(noise, settings.increment_gate)
        self.begin_with(window)

    def begin_with(self, window: GraphWindow) -> None:
        """Let a window be the graph that is reported; it uses odometry."""
        self.pair = WindowPair(window, self._noise)
        self._trial = OdometryTrial(self.pair, self._settings.gate.reanchor_after_s)
        self._newest_s, self._is_concluding = -np.inf, False
        self._alarm, self._alarm_of = InnovationAlarm(3), window

    @property
    def is_trusted(self) -> bool:
        """Whether the graph that is reported uses odometry."""
        return self._trial.trusts

    def add(self, increment: Increment, since_fix_s: float, fixes_hold: bool) -> bool:
        """Add an increment; return whether it was used, by either graph.

        Args:
            increment: The increment.
            since_fix_s: Time since the last used fix over which a drift adds up [s].
            fixes_hold: Whether fixes hold the estimate, and agree with it.
        """
        if fixes_hold:
            self._trial.begin()
        elif not self._holds_other():
            self.end_trial()
        user = self.pair.main if self._trial.trusts else self.pair.other
        if user is None or increment.from_s <= user.oldest_s:
            return True
        self._newest_s, self._is_concluding = increment.stamp_s, fixes_hold
        drifting = self._with_drift(increment, since_fix_s)
        admitted = self._increments.admitted(drifting, user, fixes_hold)
        if admitted is None:
            return False
        nodes = user.node_at(increment.from_s), user.node_at(increment.stamp_s)
        factor = between_factor(*nodes, increment.T_from_to, admitted.covariance)
        user.add("lidar", increment.stamp_s, [factor])
        return True

    def _with_drift(self, increment: Increment, since_fix_s: float) -> Increment:
        """Return an increment with the variance of a drift since the last fix; see `drift2`."""
        steps = since_fix_s / (increment.stamp_s - increment.from_s)
        length_m = float(np.linalg.norm(increment.T_from_to[:3, 3]))
        covariance = increment.covariance.copy()
        drift_m = self._settings.gate.odometry_drift * length_m
        covariance[3:, 3:] += drift2(steps, drift_m) * np.eye(3)
        return replace(increment, covariance=covariance)

    def conclude(self) -> bool:
        """Compare both graphs after they were solved; return whether they were exchanged.

        Once the window holds no increment any more, there is nothing to compare.
        """
        trusted = self._trial.trusts
        if self._is_concluding:
            self._is_concluding = False
            self._trial.conclude(self._increments.is_wrong, self._increments.period_s)
        elif self.pair.main.oldest_s > self._newest_s:
            self.end_trial()
        return trusted != self._trial.trusts

    def takes_fix(self, fix: Fix, is_contradicted: bool, period_s: float) -> bool:
        """Take what a fix says of both graphs; return whether the second one explains it alone.

        Args:
            fix: The fix.
            is_contradicted: Whether it contradicts the graph that is reported.
            period_s: Usual time between two fixes [s].
        """
        return self._trial.takes_fix(is_contradicted, self._other_distance2(fix, period_s))

    def gives_way(self) -> bool:
        """Report the graph without odometry, if fixes agree with it; return whether that is so."""
        return self._holds_other() and self._trial.give_way()

    def _holds_other(self) -> bool:
        """Return whether fixes agree with the second graph."""
        other = self.pair.other
        return other is not None and self._alarm_of is other and not self._alarm.is_raised

    def _other_distance2(self, fix: Fix, period_s: float) -> float | None:
        """Return a fix's squared distance from the second graph; None if that is contradicted."""
        other = self.pair.other
        if other is None or fix.stamp_s <= other.oldest_s:
            return None
        if self._alarm_of is not other:
            self._alarm, self._alarm_of = InnovationAlarm(3), other
        found, gate = compared(fix, other, None, self._noise), self._settings.gate.innovation
        self._alarm.add(found.residual, found.covariance, gate, period_s)
        return found.distance2 if found.distance2 < gate else None

    def rely(self) -> None:
        """Use odometry whatever it has shown: without fixes, nothing else holds the state."""
        self._increments.acquit()
        self._trial.trust()
        self.end_trial()

    def end_trial(self) -> None:
        """Compare nothing until fixes agree with the estimate again."""
        self._trial.dismiss()
        self.pair.drop_other()
