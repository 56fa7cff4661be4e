"""The values of a filter in one row of memory, and what is read and written of it by itself."""

import numpy as np
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import InertialState
from executive_plugins.estimation.inertial.usual_motion import UsualMotion
from executive_plugins.estimation.kalman.layout import FILTER, Block
from executive_plugins.estimation.live.packing import unpacked

from executive.arrays import Float


class PackedFilter:
    """A state, its covariance and its companions, on whose row compiled code works.

    Objects are made of the row on request: an object for each sample would cost more than the
    step to it.

    Attributes:
        block: The row, shape (1,), dtype `FILTER`.
    """

    def __init__(
        self, state: InertialState, covariance: Float, noise: InertialNoise, clock: ClockOffset
    ) -> None:
        self.block: Block = np.zeros(1, FILTER)
        # Views of single values: reading one from the row takes twenty times as long.
        self._stamp_s, self._clock_s = self.block["sample"]["stamp_s"], self.block["clock_s"]
        self._gap_s, self._holds_clock = self.block["gap_s"], self.block["holds_clock"]
        self._distance2 = self.block["distance2"]
        row = self.block[0]
        row["densities"], row["gravity_m_s2"] = noise.densities, noise.gravity_m_s2
        row["gap_s"], row["clock_s"] = -np.inf, clock.offset_s
        row["mean_rate"] = row["slow_rate"] = state.sample.rate  # see `steady_rate`
        self._usual = UsualMotion(row["usual"])
        self._clocks = int(clock.std_s > 0)  # number of companions that are clocks
        row["clocks"] = row["companions"] = self._clocks
        if self._clocks:
            row["cross"][:, 0], row["own"][0, 0] = clock.cross, clock.std_s**2
        self._state: InertialState | None = None
        self.state, self.covariance = state, covariance

    @property
    def stamp_s(self) -> float:
        """Time of the state [s]."""
        return float(self._stamp_s.item())

    @property
    def state(self) -> InertialState:
        """The state."""
        if self._state is None:
            self._state = unpacked(self.block)[0]
        return self._state

    @state.setter
    def state(self, state: InertialState) -> None:
        row, sample = self.block[0], state.sample
        row["sample"] = sample.stamp_s, sample.since_last_s, sample.rate, sample.force
        row["R"], row["p"], row["v"] = state.R_map_imu, state.p_map_imu, state.v_map_imu
        row["gyro_bias"], row["accel_bias"] = state.gyro_bias, state.accel_bias
        self._state = state

    @property
    def covariance(self) -> Float:
        """A copy of the covariance of the state's error, shape (15, 15)."""
        return np.array(self.block["P"][0])

    @covariance.setter
    def covariance(self, covariance: Float) -> None:
        self.block["P"][0] = covariance

    @property
    def clock_s(self) -> float:
        """Stamps of the fixes minus times of measurement [s]."""
        return float(self._clock_s.item())

    @clock_s.setter
    def clock_s(self, clock_s: float) -> None:
        self._clock_s[0] = clock_s

    @property
    def has_clock(self) -> bool:
        """Whether the offset of the receiver's clock is estimated."""
        return self._clocks > 0

    @property
    def clock_std_s(self) -> float:
        """Standard deviation of the clock's offset [s]; 0 if it is known."""
        return float(np.sqrt(self.block["own"][0, 0, 0])) if self._clocks else 0.0

    @property
    def holds_clock(self) -> bool:
        """Whether corrections leave the clock as it is, and only consider its error."""
        return bool(self._holds_clock.item())

    @holds_clock.setter
    def holds_clock(self, holds: bool) -> None:
        self._holds_clock[0] = holds

    @property
    def gap_s(self) -> float:
        """Time of the newest gap in the samples that was bridged [s]; -inf if there was none."""
        return float(self._gap_s.item())

    @property
    def usual_motion(self) -> tuple[float, float]:
        """Usual angular velocity [rad/s] and acceleration [m/s²], see `UsualMotion.step`."""
        return self._usual.step

    @property
    def distance2(self) -> float:
        """Squared Mahalanobis distance of the newest measurement; inf if it has none."""
        return float(self._distance2.item())

    @property
    def _cross(self) -> Float:
        """The covariance of the state's error with the companions', shape (15, k); no copy."""
        row = self.block[0]
        return np.asarray(row["cross"][:, : row["companions"]])

    @property
    def _own(self) -> Float:
        """The covariance of the companions' errors, shape (k, k); no copy."""
        row = self.block[0]
        return np.asarray(row["own"][: row["companions"], : row["companions"]])
