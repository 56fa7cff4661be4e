"""When fixes come, when one was used last, and whether they agree with the estimate."""

from executive_plugins.estimation.gate.gnss_gate import Compared
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm
from executive_plugins.estimation.gate.stream_period import StreamPeriod
from executive_plugins.estimation.graph.settings import SmootherSettings

_SLOWEST_S = 1.0  # receivers send a fix a second or more: their period is not known at first


class FixWatch:
    """Says after which time fixes are missing: those that come seldom are not missing.

    Attributes:
        used_s: Time of the last used fix [s], or until which none could be used.
        used_way_m: Distance travelled until the last used fix [m].
    """

    def __init__(self, settings: SmootherSettings, begin_s: float) -> None:
        self.used_s, self.used_way_m = begin_s, 0.0
        self._settings = settings
        self._alarm, self._period = InnovationAlarm(3), StreamPeriod(_SLOWEST_S)

    def add(self, compared: Compared) -> None:
        """Take a fix, used or not, beside the estimate."""
        self._period.add(compared.fix.stamp_s)
        gate, period_s = self._settings.gate.innovation, self._period.period_s
        self._alarm.add(compared.residual, compared.covariance, gate, period_s)

    def use(self, stamp_s: float, way_m: float) -> None:
        """Take the time of a used fix [s], and the distance travelled until now [m]."""
        self.used_s, self.used_way_m = max(self.used_s, stamp_s), way_m

    @property
    def contradicts(self) -> bool:
        """Whether the newest fixes are farther from the estimate than chance explains."""
        return self._alarm.is_raised

    @property
    def period_s(self) -> float:
        """Usual time between two fixes [s]."""
        return self._period.period_s

    @property
    def missing_after_s(self) -> float:
        """Time without a fix after which some are missing [s]; 0 before the first one."""
        return self._period.missing_after_s

    @property
    def suspect_after_s(self) -> float:
        """Time without a used fix until SUSPECT [s]."""
        return max(self._settings.suspect_after_s, self._period.overdue_after_s)

    @property
    def fallback_after_s(self) -> float:
        """Time without a used fix until FALLBACK [s]."""
        return max(self._settings.fallback_after_s, self._period.missing_after_s)

    def drifting_s(self, stamp_s: float) -> float:
        """Return the time since the last used fix at a stamp, until fixes are missing [s]."""
        return min(stamp_s - self.used_s, self.fallback_after_s)
