"""What a calibration begins with: the samples, the fixes, and a filter's states along the log."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
from executive_plugins.estimation.calibration.settings import KeyframeBatchSettings
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.geodesy import enu_from_geodetic
from executive.geometry.rotation import exp_so3
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

# Headings from which a solution is found, as in `WindowStart`, and how many deviations are within.
_BASIN_RAD, _SIGMAS = np.pi / 2, 3.0


class FirstGuess(GnssImuFilter):
    """The filter, run with fixes that may err by their lever arms too, and what it has seen.

    Attributes:
        samples: The samples of the sensor on the cabin.
        fixes: All fixes with the covariance that they declare.
        increments: All increments of odometry.
        states: The filter's states with a heading, in order of time.
    """

    def __init__(self, settings: KeyframeBatchSettings, machine: Rig) -> None:
        super().__init__(settings, machine)
        self._arm_std_m = settings.arm_std_m
        self.samples = SampleBuffer()
        self.fixes: list[Fix] = []
        self.increments: list[LidarIncrement] = []
        self.states: list[InertialState] = []

    @property
    def clock_s(self) -> float:
        """Stamps of the fixes minus times of measurement, as the filter has estimated it [s]."""
        return 0.0 if self._trailing is None else self._trailing.kalman.clock_s

    def start(self) -> None:
        super().start()
        self._arms_imu = dict(self._antennas_imu)
        self._antennas_imu = _telling(self._arms_imu, self._arm_std_m)
        self._restart()

    def feed(self, observations: Iterable[Observation | LidarIncrement]) -> None:
        """Run over a recording.

        Raises:
            DataError: If no state with a heading was ever found.
        """
        for observation in observations:
            if isinstance(observation, GnssFix):
                self._keep_fix(observation)
                unsure = observation.covariance_enu_m2 + self._arm_std_m**2 * np.eye(3)
                self.add_gnss(replace(observation, covariance_enu_m2=unsure))
            elif isinstance(observation, LidarIncrement):
                self.increments.append(observation)
            else:
                self.add(observation)
                self._keep_state()
        if len(self.states) < 2:
            account = self.account()
            last = f"; it {account[-1].reason}" if account else ""
            raise DataError(
                "calibration found no motion to begin with: it needs fixes, and motion that tells "
                f"the heading{last}"
            )

    def track(self) -> list[InertialState]:
        """Return the states, and before the first one what the samples say backwards."""
        gravity = np.array([0.0, 0.0, -self._cabin.gravity_m_s2])
        first = self.states[0]
        samples = [one for one in self.samples if one.stamp_s <= first.stamp_s]
        before = [first]
        for sample, earlier in pairwise(reversed(samples)):
            before.append(_undone(before[-1], sample, earlier, gravity))
        return [*reversed(before[1:]), *self.states]

    def _keep_fix(self, fix: GnssFix) -> None:
        if fix.antenna not in self._arms_imu or not np.diag(fix.covariance_enu_m2).min() > 0:
            return
        if self._datum is None:
            self._datum = fix.geodetic
        p_map = enu_from_geodetic(fix.geodetic, self._datum)
        arm = self._arms_imu[fix.antenna]
        self.fixes.append(Fix(fix.stamp_s, fix.antenna, arm, p_map, fix.covariance_enu_m2))

    def _add_cabin_sample(self, sample: ImuSample) -> None:
        before_s = self._newest_s
        super()._add_cabin_sample(sample)
        if self._newest_s != sample.stamp_s or self._newest_s == before_s:
            return  # it was refused
        since_last_s = 0.0 if before_s is None else sample.stamp_s - before_s
        rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
        self.samples.append(Inertial(sample.stamp_s, rate, force, since_last_s))

    def _keep_state(self) -> None:
        if self._trailing is None:
            return
        self._trailing.follow()
        state = self._trailing.kalman.state
        if not self.states or state.stamp_s > self.states[-1].stamp_s:
            self.states.append(state)


def _telling(arms_imu: Mapping[str, Float], arm_std_m: float) -> Mapping[str, Float]:
    """Return the antennas that the filter may use: one, if two are too close to tell the heading.

    Errors of declared arms are the same in all fixes, so that a filter that takes them for noise
    is certain of a wrong heading after a while.
    """
    apart_m = max((np.linalg.norm(a - b) for a, b in combinations(arms_imu.values(), 2)), default=0)
    if _SIGMAS * np.sqrt(2.0) * arm_std_m < _BASIN_RAD * apart_m:
        return arms_imu
    return dict(list(arms_imu.items())[:1])


def _undone(
    state: InertialState, sample: Inertial, earlier: Inertial, gravity: Float
) -> InertialState:
    """Return the state before a sample, which ends at the one before it."""
    dt_s = sample.stamp_s - earlier.stamp_s
    R = state.R_map_imu @ exp_so3(-dt_s * (sample.rate - state.gyro_bias))
    middle = state.R_map_imu @ exp_so3(-0.5 * dt_s * (sample.rate - state.gyro_bias))
    acceleration = middle @ (sample.force - state.accel_bias) + gravity
    v = state.v_map_imu - dt_s * acceleration
    p = state.p_map_imu - dt_s * v - 0.5 * dt_s**2 * acceleration
    return replace(state, sample=earlier, R_map_imu=R, v_map_imu=v, p_map_imu=p)
