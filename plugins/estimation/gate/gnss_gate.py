"""Gate for position fixes.

A fix is tested by its innovation, by agreement with the odometry over a window and, after an
outage, by agreement of several fixes in a row.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from executive_plugins.estimation.gate.drift_record import DriftRecord
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.settings import GnssGateSettings

from executive.arrays import Float

_SIGMAS = 3.0  # bound on the difference of fixes and odometry that noise explains
_FEWEST = 6  # fixes needed to detect a drift


@dataclass(frozen=True, slots=True, eq=False)
class Compared:
    """A fix beside the predictions of estimate and odometry.

    Attributes:
        fix: The fix.
        residual: Fix minus predicted antenna [m], shape (3,).
        covariance: Of the residual [m²], shape (3, 3).
        p_odometry_antenna: The antenna by odometry alone, in the odometry's own frame [m],
            shape (3,).
        R_map_odometry: Attitude of that frame, shape (3, 3).
        has_odometry: Whether lidar odometry is available. If not, the estimate itself takes its
            place, which drifts without fixes.
        slack_m: Additional error of the prediction [m].
        late_m: How far the antenna moves while the fix's stamp is late, if that was not corrected
            before [m], shape (3,).
    """

    fix: Fix
    residual: Float
    covariance: Float
    p_odometry_antenna: Float
    R_map_odometry: Float
    has_odometry: bool
    slack_m: float = 0.0
    late_m: Float = field(default_factory=lambda: np.zeros(3))

    @property
    def p_map_fix(self) -> Float:
        """The antenna by the fix at the time of its stamp [m], shape (3,)."""
        return self.fix.p_map_antenna + self.late_m

    @property
    def distance2(self) -> float:
        """Squared Mahalanobis distance."""
        return float(self.residual @ np.linalg.solve(self.covariance, self.residual))

    def moved_since(self, earlier: "Compared") -> Float:
        """Return how far the fix moved beyond the odometry since an earlier one [m], shape (3,)."""
        by_odometry = self.R_map_odometry @ (self.p_odometry_antenna - earlier.p_odometry_antenna)
        return self.p_map_fix - earlier.p_map_fix - by_odometry


class GnssGate:
    """Decides which fixes are used, and gives the reason if it refuses one.

    The paper's gate compares consecutive raw fixes with a fixed distance (Nubert 2022,
    Sec. IV-C1). Such a gate passes a wrong fix that stays wrong for a second, and any slow drift.
    Here one fix is compared with the estimate, and several with the odometry, which is independent
    of them.
    """

    def __init__(self, settings: GnssGateSettings) -> None:
        self._settings = settings
        self._window: deque[Compared] = deque()
        self._record = DriftRecord(settings.window_s)
        self._run: list[Compared] = []
        self._refused_since_s: float | None = None

    def forget_odometry(self) -> None:
        """Drop the comparisons with the odometry, after it has started again."""
        self._window.clear()
        self._run.clear()

    def refusal(self, compared: Compared) -> str:
        """Return why a fix is not used while the estimate is global; empty if it is used."""
        if compared.distance2 > self._settings.innovation:
            return f"{_norm(compared.residual):.2f} m off the estimate"
        if not compared.has_odometry:
            return ""
        self._window.append(compared)
        while self._window[0].fix.stamp_s < compared.fix.stamp_s - self._settings.window_s:
            self._window.popleft()
        window = tuple(self._window)
        way_m, least_s = _way(window), 0.5 * self._settings.window_s
        usual_m = max(self._settings.window_drift_m, self._record.share * way_m)
        drift_m = _drift(window, usual_m, least_s)
        if _spans(window, least_s):
            self._record.add(compared.fix.stamp_s, _moved(window), way_m)
        return f"drifted by {drift_m:.2f} m against the odometry" if drift_m else ""

    def begin_recovery(self) -> None:
        """Drop earlier comparisons, after the estimate has fallen back."""
        self._run.clear()
        self._refused_since_s = None

    def is_in_line(self, compared: Compared, missing_after_s: float = 0.0) -> bool:
        """Add a fix during fallback; return whether it agrees with the fixes before it.

        Args:
            compared: The fix.
            missing_after_s: Time after which fixes are missing that come as often as these [s]:
                the first after a longer silence begins anew.
        """
        if self._refused_since_s is None:
            self._refused_since_s = compared.fix.stamp_s
        longest_s = max(self._settings.recover_after_s, missing_after_s)
        if self._run and not self._agrees(compared, longest_s):
            self._run = [compared]
            return False
        self._run.append(compared)
        settings = self._settings
        recent = self._since(compared.fix.stamp_s - settings.recover_after_s)
        if compared.has_odometry and _drift(
            recent, settings.recover_drift_m, 0.9 * settings.recover_after_s
        ):
            self._run = self._run[-1:]
            return False
        return True

    def verdict(self, way_m: float, lost_s: float) -> str:
        """Return why the sequence of agreeing fixes is used again; empty if it is not used yet.

        Args:
            way_m: Distance travelled since the last used fix [m].
            lost_s: Time of the last used fix [s].
        """
        settings, last = self._settings, self._run[-1]
        now_s = last.fix.stamp_s
        off_m, lasted_s = _norm(last.residual), now_s - self._run[0].fix.stamp_s
        enough = (
            len(self._run) >= settings.recover_after and lasted_s >= settings.recover_after_s - 1e-6
        )
        spread_m = _SIGMAS * float(np.sqrt(np.linalg.eigvalsh(last.covariance)[-1]))
        drift_m = settings.odometry_drift * way_m + settings.odometry_drift_m_s * (now_s - lost_s)
        if not last.has_odometry:
            drift_m += 0.5 * settings.inertial_drift_m_s2 * (now_s - lost_s) ** 2
        if enough and off_m < spread_m + drift_m:
            return f"{len(self._run)} fixes in a row agree, {off_m:.2f} m off"
        if lasted_s > settings.reanchor_after_s:
            return f"fixes agree for {lasted_s:.0f} s, {off_m:.2f} m off: position reset to them"
        if (
            self._refused_since_s is not None
            and now_s - self._refused_since_s > settings.unlock_after_s
        ):
            return (
                f"fixes refused for {settings.unlock_after_s:.0f} s, {off_m:.2f} m off: "
                "position reset to them"
            )
        return ""

    def agreed(self, after_s: float) -> Sequence[Compared]:
        """Return the agreeing fixes from a time on, at most of the time that recovery takes."""
        since_s = self._run[-1].fix.stamp_s - self._settings.recover_after_s
        return self._since(max(after_s, since_s))

    def _since(self, stamp_s: float) -> tuple[Compared, ...]:
        return tuple(c for c in self._run if c.fix.stamp_s >= stamp_s)

    def _agrees(self, compared: Compared, longest_s: float) -> bool:
        last = self._run[-1]
        if compared.fix.stamp_s - last.fix.stamp_s > longest_s:
            return False
        return _norm(compared.moved_since(last)) < self._settings.jump_m + compared.slack_m


def _way(compared: Sequence[Compared]) -> float:
    """Return the distance travelled by odometry [m], from the antenna of the newest fix."""
    antenna = compared[-1].fix.antenna
    positions = [c.p_odometry_antenna for c in compared if c.fix.antenna == antenna]
    return float(np.linalg.norm(np.diff(positions, axis=0), axis=-1).sum())


def _spans(compared: Sequence[Compared], least_s: float) -> bool:
    """Return whether there are enough fixes, over enough time, to detect a drift."""
    over_s = compared[-1].fix.stamp_s - compared[0].fix.stamp_s if compared else 0.0
    return len(compared) >= _FEWEST and over_s >= least_s


def _moved(compared: Sequence[Compared]) -> float:
    """Return how far fixes and odometry moved apart between the first and last third [m]."""
    third, newest = len(compared) // 3, compared[-1]
    by_odometry = np.array([c.p_odometry_antenna for c in compared]) @ newest.R_map_odometry.T
    offsets = np.array([c.p_map_fix for c in compared]) - by_odometry
    return _norm(offsets[-third:].mean(axis=0) - offsets[:third].mean(axis=0))


def _drift(compared: Sequence[Compared], limit_m: float, least_s: float) -> float:
    """Return how far fixes and odometry drifted apart over a window [m].

    It is 0 if the drift is within the limit and the noise, or if there are too few fixes.
    """
    if not _spans(compared, least_s):
        return 0.0
    fix, third = compared[-1].fix, len(compared) // 3
    noise_m = _SIGMAS * float(np.sqrt(2 * np.trace(fix.covariance) / third))
    moved_m = _moved(compared)
    return moved_m if moved_m > limit_m + noise_m else 0.0


def _norm(v: Float) -> float:
    return float(np.linalg.norm(v))
