"""The first state: from rest with two antennas, from motion otherwise."""

import math
from collections.abc import Mapping

import numpy as np
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import GYRO_BIAS, Inertial, InertialState
from executive_plugins.estimation.start.at_rest import RestInitialisation
from executive_plugins.estimation.start.chassis_level import ChassisLevel
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.rest_bias import RestBias
from executive_plugins.estimation.start.settings import RestSettings, WindowStartSettings
from executive_plugins.estimation.start.wide_heading import heading_std
from executive_plugins.estimation.start.window_start import WindowStart

from executive.arrays import Float

# Between two attempts to find rest: each takes milliseconds.
_PERIOD_S = 0.1
_PATIENCE = 3.0  # durations of rest that a start from rest may take


class FirstState:
    """Collects samples and fixes until a first state is found.

    Attributes:
        waits_for: What is missing for a first state, if that is known; empty before the first
            attempt.
    """

    def __init__(
        self,
        rest: RestSettings,
        window: WindowStartSettings,
        antennas_imu: Mapping[str, Float],
        noise: InertialNoise,
        chassis: ChassisLevel | None,
        clock_std_s: float = 0.0,
    ) -> None:
        self._max_rate_rad_s, self._rest_s = rest.max_rate_rad_s, rest.duration_s
        self._first_s = math.inf
        self._has_heading = len(antennas_imu) > 1
        self._rest = RestInitialisation(rest, antennas_imu, noise, chassis)
        self._rest_bias = RestBias(rest.duration_s)
        self._window = WindowStart(window, noise, clock_std_s)
        self._max_heading_std_rad, self._clock_std_s = window.max_heading_std_rad, clock_std_s
        self._antennas_imu = antennas_imu
        self._tried_s = -math.inf
        self._moves = False  # by the last attempt to find rest
        self._is_vague = False  # a rest was found, but the fixes do not tell the heading
        self.waits_for = ""

    def add_fix(
        self, stamp_s: float, antenna: str, p_map_antenna: Float, covariance: Float
    ) -> None:
        """Add a fix.

        Args:
            stamp_s: Time of measurement [s].
            antenna: Name of the antenna.
            p_map_antenna: Its measured position in the map [m], shape (3,).
            covariance: Of the position [m²], shape (3, 3).
        """
        self._rest.add_fix(
            stamp_s, antenna, p_map_antenna, float(np.sqrt(np.diag(covariance).max()))
        )
        arm_imu = self._antennas_imu[antenna]
        self._window.add_fix(Fix(stamp_s, antenna, arm_imu, p_map_antenna, covariance))

    def add_sample(self, sample: Inertial, turn_rate_rad_s: float) -> Found | None:
        """Add an inertial sample; return a state if one was found just now.

        Args:
            sample: The sample.
            turn_rate_rad_s: Rate of the turn joint [rad/s]. A cabin that turns steadily could look
            at rest to its own sensor.

        Returns:
            The state at the sample. States without a heading are followed by better ones.
        """
        self._first_s = min(self._first_s, sample.stamp_s)
        self._rest.add_sample(sample)
        self._window.add_sample(sample)
        at_rest = self._at_rest(sample, turn_rate_rad_s)
        if at_rest is not None and heading_std(*at_rest) <= self._max_heading_std_rad:
            return Found(*at_rest, True, ClockOffset(std_s=self._clock_std_s))
        if at_rest is not None:
            self._take_rest(*at_rest)
            self._is_vague = True
        if self._has_heading and not self._is_given_up(sample.stamp_s):
            return None
        found = self._window.state()
        if self._window.waits_for:
            self.waits_for = self._window.waits_for
        return found

    def _take_rest(self, state: InertialState, P: Float) -> None:
        """Tell the window the bias of the gyroscope, which its fixes may not."""
        noise = float(np.sqrt(np.diag(P[GYRO_BIAS, GYRO_BIAS]).max()))
        error = max(noise, self._rest.unrest_rad_s())
        if self._rest_bias.add(state.stamp_s, state.gyro_bias, error):
            self._window.take_rest(self._rest_bias.rate, self._rest_bias.std_rad_s)

    def _at_rest(
        self, sample: Inertial, turn_rate_rad_s: float
    ) -> tuple[InertialState, Float] | None:
        if abs(turn_rate_rad_s) >= self._max_rate_rad_s:
            self._moves = True
            self.waits_for = (
                f"rest: the cabin turns on its chassis at {abs(turn_rate_rad_s):.3f} rad/s"
            )
            return None
        if sample.stamp_s - self._tried_s < _PERIOD_S:
            return None
        self._tried_s = sample.stamp_s
        found = self._rest.state()
        self.waits_for, self._moves = self._rest.waits_for, self._rest.moves
        return found

    def _is_given_up(self, now_s: float) -> bool:
        """Return whether a state from rest is not to be waited for.

        It is the more accurate one, and comes within seconds; but not to a body that moves, nor
        where an antenna is silent or slow, or the fixes are too coarse for their distance.
        """
        return self._moves or self._is_vague or now_s - self._first_s > _PATIENCE * self._rest_s
