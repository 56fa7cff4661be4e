"""The first state: from rest with two antennas, from the first metres of motion with one."""

import math
from collections.abc import Mapping

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.start.at_rest import RestInitialisation
from executive_plugins.estimation.start.chassis_level import ChassisLevel
from executive_plugins.estimation.start.in_motion import MovingStart
from executive_plugins.estimation.start.settings import MovingStartSettings, RestSettings

from executive.arrays import Float

# Between two attempts to find rest: each takes milliseconds.
_PERIOD_S = 0.1


class FirstState:
    """Collects samples and fixes until a first state is found.

    Attributes:
        waits_for: What is missing for a first state, if that is known; empty before the first
            attempt.
    """

    def __init__(
        self,
        rest: RestSettings,
        moving: MovingStartSettings,
        antennas_imu: Mapping[str, Float],
        noise: InertialNoise,
        chassis: ChassisLevel | None,
    ) -> None:
        self._max_rate_rad_s = rest.max_rate_rad_s
        self._has_heading = len(antennas_imu) > 1
        self._rest = RestInitialisation(rest, antennas_imu, noise, chassis)
        self._moving = MovingStart(moving, next(iter(antennas_imu.values())), noise)
        self._tried_s = -math.inf
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
        self._moving.add_fix(stamp_s, p_map_antenna)

    def add_sample(
        self, sample: Inertial, turn_rate_rad_s: float
    ) -> tuple[InertialState, Float] | None:
        """Add an inertial sample; return the first state if it is found.

        Args:
            sample: The sample.
            turn_rate_rad_s: Rate of the turn joint [rad/s]. A cabin that turns steadily could look
            at rest to its own sensor.

        Returns:
            The state at the sample and its error's covariance (15, 15), or None.
        """
        self._rest.add_sample(sample)
        at_rest = None
        if abs(turn_rate_rad_s) >= self._max_rate_rad_s:
            self.waits_for = (
                f"rest: the cabin turns on its chassis at {abs(turn_rate_rad_s):.3f} rad/s"
            )
        elif sample.stamp_s - self._tried_s >= _PERIOD_S:
            self._tried_s = sample.stamp_s
            at_rest = self._rest.state()
            self.waits_for = self._rest.waits_for or (
                "" if self._has_heading else "motion, which gives the heading"
            )
        if self._has_heading:
            return at_rest
        self._moving.add_sample(sample)
        if at_rest is not None:
            self._moving.begin(*at_rest)
        return self._moving.state()
