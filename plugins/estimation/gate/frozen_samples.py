"""Inertial samples that repeat to the bit: a driver that hands out its last sample again."""

from executive.messages.imu import ImuSample

# No gyroscope resolves such rates [rad/s]: one that shows them has no noise, and is at rest.
_NO_RATE_RAD_S = 1e-9


class FrozenSamples:
    """How long a sensor that has noise has shown none.

    Six values of a live sensor do not repeat to the bit. A sensor that never varied is not judged,
    nor one that is simulated without noise, at rest: it feels gravity, and turns by nothing at all.
    One that hands out zeros alone is frozen.
    """

    def __init__(self) -> None:
        self._values: list[float] = []
        self._since_s = 0.0
        self._changes = 0

    def lasts_s(self, sample: ImuSample) -> float:
        """Take a sample; return for how long its values have not changed [s]."""
        values = sample.angular_velocity_rad_s.tolist() + sample.specific_force_m_s2.tolist()
        if values == self._values:
            is_judged = self._changes > 1 and not _is_ideal_rest(values)
            return sample.stamp_s - self._since_s if is_judged else 0.0
        self._values, self._since_s = values, sample.stamp_s
        self._changes += 1
        return 0.0


def _is_ideal_rest(values: list[float]) -> bool:
    """Return whether rates (the first three) are nothing, and forces are not."""
    return max(map(abs, values[:3])) < _NO_RATE_RAD_S and any(values[3:])
