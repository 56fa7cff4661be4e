"""A filter beside a second one, of which one uses odometry and the other does not."""

from collections.abc import Mapping

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.filters.cloning_filter import CloningFilter
from executive_plugins.estimation.gate.innovation_record import DOUBTED, InnovationRecord
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.odometry_trial import COMPARED
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.exponential import linear_covariance
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import InertialState
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.start.chassis import ChassisRest
from executive_plugins.estimation.start.settings import StandstillSettings

from executive.arrays import Float
from executive.geometry.rotation import log_so3

_NO_CLOCK = ClockOffset()


class WitnessedFilter(CloningFilter):
    """The filter that is reported, and another that differs from it by the odometry alone.

    What separates the two is the odometry's doing. Two estimates of which one uses a measurement
    in addition differ by no more than the covariance of the other (solution separation, Brown and
    McBurney 1988), so that this needs no model of how the odometry fails.

    Attributes:
        other: The second filter, at the time of the first.
    """

    def __init__(
        self, state: InertialState, covariance: Float, noise: InertialNoise, clock: ClockOffset
    ) -> None:
        super().__init__(state, covariance, noise, clock)
        self.other = CloningFilter(state, covariance, noise, clock)
        self._noise = noise
        self._records: list[tuple[InnovationRecord, InnovationRecord]] = []
        self._other_records: Mapping[str, InnovationRecord] = {}

    def predict_until(self, ring: Block, first: int, end: int, until_s: float) -> int:
        self.other.predict_until(ring, first, end, until_s)
        return super().predict_until(ring, first, end, until_s)

    def packed_at(self, ring: Block, first: int, end: int, until_s: float) -> tuple[int, Block]:
        answer = super().packed_at(ring, first, end, until_s)
        self.other.predict_until(ring, first, end, until_s)  # does nothing if it is there already
        return answer

    def correct_by_standstill(
        self, T_imu_cabin: Float, rest: ChassisRest, settings: StandstillSettings, gate: float
    ) -> bool:
        self.other.correct_by_standstill(T_imu_cabin, rest, settings, gate)
        return super().correct_by_standstill(T_imu_cabin, rest, settings, gate)

    def judge_by(
        self, own: Mapping[str, InnovationRecord], other: Mapping[str, InnovationRecord]
    ) -> None:
        """Set the innovations of both filters by antenna, which go with the states."""
        self._records = [(own[name], other[name]) for name in own]
        self._other_records = other

    def correct_other(self, fix: Fix, late_s: float, period_s: float) -> bool:
        """Correct the second filter by a fix; return whether the fix contradicts it.

        The clock is the first filter's to learn: the second only considers its error.

        Args:
            fix: The fix.
            late_s: By how much its stamp was thought to be late when it was queued [s].
            period_s: Usual time between two fixes of any antenna [s].
        """
        record = self._other_records[fix.antenna]
        record.expect(period_s)
        said = self.other.use_fix(record.block, fix, late_s, self.holds_clock)
        if said & DOUBTED:
            self.other.correct_by_compared(float(record.block[0]["gate"]))
        return bool(said & DOUBTED)

    def separation2(self) -> float:
        """Return the squared distance of both in the covariance of the one without odometry.

        The larger covariance is that one's, whichever of the two it is.
        """
        own, other = self.state, self.other.state
        turn = log_so3(own.R_map_imu.T @ other.R_map_imu)
        apart = [turn, other.v_map_imu - own.v_map_imu, other.p_map_imu - own.p_map_imu]
        loose = max(self, self.other, key=lambda one: float(np.trace(one.covariance[:9, :9])))
        covariance = linear_covariance(loose.state, loose.covariance)
        return squared_distance(covariance[:COMPARED, :COMPARED], np.concatenate(apart))

    def renew_other(self) -> None:
        """Let the second filter be as the first is, without a clone until it uses odometry."""
        self.other.become(self)
        self.other.drop_clone()
        for own, other in self._records:
            other.block[:] = own.block

    def exchange(self) -> None:
        """Let each filter be as the other one is."""
        kept = CloningFilter(self.state, self.covariance, self._noise, _NO_CLOCK)
        kept.become(self)
        self.become(self.other)
        self.other.become(kept)
        for own, other in self._records:
            own.block[:], other.block[:] = other.block.copy(), own.block.copy()
