"""Inertial samples that repeat to the bit: a driver that hands out its last sample again."""

from executive.messages.imu import ImuSample


class FrozenSamples:
    """How long a sensor that has noise has shown none.

    Six values of a live sensor do not repeat to the bit. A sensor that never varied, such as one
    that is simulated without noise at rest, is not judged.
    """

    def __init__(self) -> None:
        self._values = (b"", b"")  # compared as bytes, which is fast: this runs for each sample
        self._since_s = 0.0
        self._changes = 0

    def lasts_s(self, sample: ImuSample) -> float:
        """Take a sample; return for how long its values have not changed [s]."""
        rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
        values = (rate + 0.0).tobytes(), (force + 0.0).tobytes()  # -0.0 + 0.0 is 0.0
        if values == self._values:
            return sample.stamp_s - self._since_s if self._changes > 1 else 0.0
        self._values, self._since_s = values, sample.stamp_s
        self._changes += 1
        return 0.0
