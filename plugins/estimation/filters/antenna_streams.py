"""The fixes of each antenna as they come: how often, and what their innovations show."""

from collections.abc import Iterable

from executive_plugins.estimation.gate.innovation_alarm import WINDOW
from executive_plugins.estimation.gate.innovation_record import InnovationRecord
from executive_plugins.estimation.gate.stream_period import StreamPeriod
from executive_plugins.estimation.kalman.layout import Block

STEP_AGO_S = 1.0  # by which a step of the biases may have begun to show


class AntennaStreams:
    """Periods and innovations by antenna.

    Attributes:
        records: Innovations by antenna; empty before the first state.
        missing_after_s: Time without a used fix after which fixes are missing [s].
    """

    def __init__(self, fallback_after_s: float) -> None:
        """Begin without fixes.

        Args:
            fallback_after_s: The least time without a used fix after which they are missing [s].
        """
        self.records: dict[str, InnovationRecord] = {}
        self.missing_after_s = self._fallback_after_s = fallback_after_s
        self._periods: dict[str, StreamPeriod] = {}

    def add(self, antenna: str, stamp_s: float) -> None:
        """Take the time of a fix as it arrives [s]."""
        self._periods.setdefault(antenna, StreamPeriod()).add(stamp_s)
        usual_s = min(period.missing_after_s for period in self._periods.values())
        self.missing_after_s = max(self._fallback_after_s, usual_s)
        for name, record in self.records.items():
            if name in self._periods:
                record.expect(self.shared_period_s(name))

    def place(self, antenna: str) -> int:
        """Return the number of an antenna among the records."""
        return list(self.records).index(antenna)

    def renew(self) -> None:
        """Forget what was said of another state."""
        for record in self.records.values():
            record.renew()

    def clear_biases(self) -> None:
        """Forget by what innovations lean: it is part of the prediction now."""
        for record in self.records.values():
            record.clear_bias()

    def period_s(self, antenna: str) -> float:
        """Return the usual time between two fixes of an antenna [s]."""
        return self._periods[antenna].period_s

    def shared_period_s(self, antenna: str) -> float:
        """Return the usual time between two fixes of any, if all are as frequent as one [s]."""
        return self.period_s(antenna) / len(self._periods)

    def ago_s(self, antenna: str) -> float:
        """Return how long before the fix that shows it an error may have begun [s]."""
        return max(STEP_AGO_S, WINDOW * self.period_s(antenna))


def antenna_records(
    antennas: Iterable[str], known: tuple[float, float, float], rows: Block
) -> dict[str, InnovationRecord]:
    """Return an empty record of innovations for each antenna, over rows of memory.

    Args:
        antennas: Their names.
        known: Gate, time for which a scale is kept [s], and the scale at first.
        rows: The memory, dtype `INNOVATIONS`.
    """
    return {name: InnovationRecord(*known, rows[k : k + 1]) for k, name in enumerate(antennas)}
