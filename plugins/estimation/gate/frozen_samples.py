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
        self._newest: ImuSample | None = None  # that differed from the one before
        self._first = float("nan")  # value of it
        self._changes = 0

    def lasts_s(self, sample: ImuSample) -> float:
        """Take a sample; return for how long its values have not changed [s]."""
        first = sample.angular_velocity_rad_s.item(0)
        # Fast path: nearly all samples differ in their first value.
        if first == self._first:
            before = self._newest
            if before is not None and _are_equal(before, sample):
                is_judged = self._changes > 1 and not _is_ideal_rest(sample)
                return sample.stamp_s - before.stamp_s if is_judged else 0.0
        self._newest, self._first = sample, first
        self._changes += 1
        return 0.0


def _is_ideal_rest(sample: ImuSample) -> bool:
    """Return whether rates are nothing, and forces are not."""
    rates, forces = sample.angular_velocity_rad_s.tolist(), sample.specific_force_m_s2.tolist()
    return max(map(abs, rates)) < _NO_RATE_RAD_S and any(forces)


def _are_equal(one: ImuSample, other: ImuSample) -> bool:
    """Return whether all values of two samples are equal."""
    pairs = (
        (one.angular_velocity_rad_s, other.angular_velocity_rad_s),
        (one.specific_force_m_s2, other.specific_force_m_s2),
    )
    return all(a.tolist() == b.tolist() for a, b in pairs)
