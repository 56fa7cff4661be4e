"""Inertial samples that repeat to the bit: a driver that hands out its last sample again."""

from executive.messages.imu import ImuSample


class FrozenSamples:
    """How long a sensor that has noise has shown none.

    Six values of a live sensor do not repeat to the bit. A sensor that never varied, such as one
    that is simulated without noise at rest, is not judged.
    """

    def __init__(self) -> None:
        self._values: list[float] = []
        self._since_s = 0.0
        self._changes = 0

    def lasts_s(self, sample: ImuSample) -> float:
        """Take a sample; return for how long its values have not changed [s]."""
        values = sample.angular_velocity_rad_s.tolist() + sample.specific_force_m_s2.tolist()
        if values == self._values:
            return sample.stamp_s - self._since_s if self._changes > 1 else 0.0
        self._values, self._since_s = values, sample.stamp_s
        self._changes += 1
        return 0.0
