"""Position and velocity while the heading is not known yet."""

from executive_plugins.estimation.cabin.aligning_witness import AligningWitness
from executive_plugins.estimation.cabin.heading_bank import HeadingBank
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.kalman.trailing_filter import Correction, TrailingFilter
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.found import Found

_LAG_S = 0.1  # at first; the filter trails by more once a fix comes later


class Aligning:
    """The state of a body whose heading is not known, from one attempt to find it to the next."""

    def __init__(
        self,
        found: Found,
        noise: InertialNoise,
        propagator: LivePropagator,
        gate: float,
        witness: AligningWitness,
    ) -> None:
        """Begin at a state, and set the propagator to it.

        Args:
            found: The state.
            noise: Noise of the inertial sensor.
            propagator: Reports the state at the newest sample.
            gate: Largest squared Mahalanobis distance of a fix.
            witness: What fixes say of the states so far.
        """
        self._late_s, self._scale, self._gate = found.clock.offset_s, found.fix_scale, gate
        self._bank = HeadingBank(found, noise, witness)
        self._trailing = TrailingFilter(self._bank, _LAG_S, propagator)

    def add_sample(self, stamp_s: float) -> None:
        """Follow an inertial sample that the propagator has taken [s]."""
        self._trailing.add_sample(stamp_s)

    def add_fix(self, fix: Fix) -> None:
        """Correct by a fix."""
        late_s = self._late_s

        def apply() -> None:
            self._bank.correct(fix, late_s, self._scale, self._gate)

        self._trailing.add(Correction(fix.stamp_s - late_s, apply))
