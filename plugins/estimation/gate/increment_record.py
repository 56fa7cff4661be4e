"""What the innovations of one stream of odometry have shown, and whether it is used."""

from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm
from executive_plugins.estimation.gate.innovation_bias import InnovationBias
from executive_plugins.estimation.gate.innovation_scale import InnovationScale
from executive_plugins.estimation.gate.stream_period import StreamPeriod

from executive.arrays import Float


class IncrementRecord:
    """Scales the covariance of increments that scatter, and refuses a stream that leans.

    Odometry that has lost its scene stands still or jumps, and says nothing of it. The prediction
    is the witness: over an increment, it errs by the velocity's error only, which good fixes keep
    small, and which grows without them. Odometry that drifts disagrees a little each time; there,
    the factor by which it does so is applied to its covariance. Where fixes hold the prediction,
    increments that lean to one side are no noise, and are refused: with a way that is too long by
    half, they would draw the state along until the fixes counted as outliers. Fixes that drift make
    increments lean as well, once they have drawn the state along, but contradict it before: who is
    refused is decided when a lean begins, and holds until it has ended.

    Attributes:
        is_wrong: Whether the odometry is refused by its newest innovations.
    """

    def __init__(self, gate: float) -> None:
        """Make one without innovations.

        Args:
            gate: Largest squared Mahalanobis distance of an increment.
        """
        self.is_wrong, self._gate = False, gate
        self._scale, self._alarm = InnovationScale(6), InnovationAlarm(6)
        self._bias, self._period = InnovationBias(6), StreamPeriod()
        self._leans = False

    def take(
        self, stamp_s: float, innovation: Float, predicted: Float, declared: Float, is_tied: bool
    ) -> Float | None:
        """Take an innovation; return the covariance that the record explains, None to refuse it.

        Args:
            stamp_s: Time of the increment's end [s].
            innovation: Measured minus predicted motion, shape (6,).
            predicted: Covariance of the prediction, shape (6, 6).
            declared: Covariance that the odometry declares, shape (6, 6).
            is_tied: Whether fixes hold the prediction, and agree with it.
        """
        self._period.add(stamp_s)
        known, period_s = predicted + self._scale.factor() * declared, self._period.period_s
        self._alarm.add(innovation, known, self._gate, period_s)
        self._bias.add(innovation, known, period_s)
        self._scale.add(innovation, predicted, declared)
        leans = self._alarm.is_raised or self._bias.is_biased
        if leans != self._leans:
            self._leans, self.is_wrong = leans, leans and is_tied
        covariance = self._scale.factor() * declared
        is_near = squared_distance(predicted + covariance, innovation) <= self._gate
        return covariance if is_near and not self.is_wrong else None

    @property
    def period_s(self) -> float:
        """Usual time between two increments [s]."""
        return self._period.period_s

    def acquit(self) -> None:
        """Use the odometry of a present lean again: without fixes, nothing else holds the state."""
        self.is_wrong = False
