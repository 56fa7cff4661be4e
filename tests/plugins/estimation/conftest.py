"""A swinging cabin whose motion is known in closed form, measured by noisy sensors."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.filters.settings import GnssImuSettings
from executive_plugins.estimation.graph.dual_graph import DualGraph
from executive_plugins.estimation.graph.settings import DualGraphSettings

from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3, from_rpy
from executive.machine.machine import Machine, load_machine
from executive.machine.sensor import Imu
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

LIDAR = "lidar_horizontal"
DATUM = np.array([47.4084, 8.5106, 440.0])


@dataclass
class SwingingCabin:
    """A chassis at rest on a slope; the cabin rests, then swings as a·(1 − cos(2πt/T))/2, then
    rests again.

    With 3.2 rad in 12 s it reaches 0.84 rad/s.
    """

    machine: Machine
    swing_rad: float = 3.2
    period_s: float = 12.0
    rest_s: float = 6.0
    gnss_latency_s: float = 0.04
    noise: float = 1.0
    seed: int = 1
    T_map_base: np.ndarray = field(
        default_factory=lambda: pose(from_rpy(0.03, -0.05, 0.9), np.array([4.0, -7.0, 1.2]))
    )
    gyro_bias: np.ndarray = field(default_factory=lambda: np.array([0.002, -0.0015, 0.001]))
    accel_bias: np.ndarray = field(default_factory=lambda: np.array([0.02, -0.03, 0.01]))

    def turn(self, t: float) -> tuple[float, float]:
        """Return angle and rate of the turn joint."""
        u, w = t - self.rest_s, 2 * np.pi / self.period_s
        if not 0 <= u < 2 * self.period_s:
            return 0.0, 0.0
        a = 0.5 * self.swing_rad
        return a * (1 - np.cos(w * u)), a * w * np.sin(w * u)

    def T_map_cabin(self, t: float) -> np.ndarray:
        joint = self.machine.joints[0]
        return self.T_map_base @ joint.T_parent_joint @ pose(from_rpy(0, 0, self.turn(t)[0]))

    def imu(self, name: str, t: float, rng: np.random.Generator, dt: float = 0.01) -> ImuSample:
        """Measure the mean over the last dt: rate by the change of angle, force by the change of
        velocity.
        """
        sensor = self.machine.sensors[name]
        on_cabin = sensor.link == self.machine.cabin_link
        rate, T_map_link, acceleration = np.zeros(3), self.T_map_base, np.zeros(3)
        if on_cabin:
            rate = np.array([0, 0, (self.turn(t)[0] - self.turn(t - dt)[0]) / dt])
            T_map_link = self.T_map_cabin(t - dt / 2)
            acceleration = (self.velocity(t, sensor) - self.velocity(t - dt, sensor)) / dt
        f = T_map_link[:3, :3].T @ (acceleration + np.array([0, 0, 9.81]))
        R = sensor.T_link_sensor[:3, :3].T
        return ImuSample(
            t,
            name,
            R @ rate + self.gyro_bias + self.noise * rng.normal(0, sensor.gyro_noise_rad_s, 3),
            R @ f + self.accel_bias + self.noise * rng.normal(0, sensor.accel_noise_m_s2, 3),
        )

    def velocity(self, t: float, sensor: Imu) -> np.ndarray:
        """Return the velocity of a sensor on the cabin, map axes."""
        w = np.array([0, 0, self.turn(t)[1]])
        return self.T_map_cabin(t)[:3, :3] @ np.cross(w, sensor.T_link_sensor[:3, 3])

    def fix(self, name: str, t: float, rng: np.random.Generator) -> GnssFix:
        sensor = self.machine.sensors[name]
        std = np.array(
            [sensor.horizontal_noise_m, sensor.horizontal_noise_m, sensor.vertical_noise_m]
        )
        p = transform(self.T_map_cabin(t), sensor.T_link_sensor[:3, 3]) + self.noise * rng.normal(
            0, std
        )
        return GnssFix(t, name, geodetic_from_enu(p, DATUM), np.diag(std**2), True)

    def joints(self, t: float, rng: np.random.Generator) -> JointSample:
        names = self.machine.joint_names
        position, velocity = np.zeros(len(names)), np.zeros(len(names))
        position[0], velocity[0] = self.turn(t)
        position += self.noise * rng.normal(0, 2e-4, len(names))
        velocity += self.noise * rng.normal(0, 2e-3, len(names))
        return JointSample(t, names, position, velocity, np.zeros(len(names)))

    def observations(self, end_s: float, start_s: float = 0.0) -> Iterator[Observation]:
        """Yield what is measured, in order of arrival: IMUs and joints at 100 Hz, fixes at 20 Hz
        and late.
        """
        rng = np.random.default_rng(self.seed)
        late = round(self.gnss_latency_s * 100)
        for k in range(round(100 * start_s), round(100 * end_s)):
            t = k / 100
            yield self.imu("imu_cabin", t, rng)
            yield self.imu("imu_base", t, rng)
            yield self.joints(t, rng)
            if (k - late) % 5 == 0 and k >= late:
                yield self.fix("gnss_left", (k - late) / 100, rng)
                yield self.fix("gnss_right", (k - late) / 100, rng)


@pytest.fixture(scope="session")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture
def cabin(machine: Machine) -> SwingingCabin:
    return SwingingCabin(machine)


@pytest.fixture
def start(machine: Machine) -> Callable[..., GnssImuFilter]:
    """Make and start a filter with other settings."""

    def start(**settings: object) -> GnssImuFilter:
        estimator = GnssImuFilter(GnssImuSettings(**settings), machine)
        estimator.start()
        return estimator

    return start


@pytest.fixture
def estimator(start: Callable[..., GnssImuFilter]) -> GnssImuFilter:
    """A filter of default settings."""
    return start()


@pytest.fixture
def begin(machine) -> Iterator[Callable[..., DualGraph]]:
    """Make and start estimators; close them in the end."""
    begun = []

    def begin(**settings: object) -> DualGraph:
        settings = {
            "smoother": {"lag_s": 1.5}
        } | settings  # half the default: the tests take half the time
        estimator = DualGraph(DualGraphSettings(**settings), machine)
        estimator.start()
        begun.append(estimator)
        return estimator

    yield begin
    for estimator in begun:
        estimator.close()


@pytest.fixture
def with_lidar():
    """Put lidar increments between observations."""

    def with_lidar(cabin, observations, std_m=0.005, std_rad=0.0005):
        """Yield the observations and, after each tenth cabin sample, the increment since the last,
        late by 50 ms.
        """
        rng = np.random.default_rng(7)
        T_cabin_lidar = cabin.machine.sensors[LIDAR].T_link_sensor
        covariance = np.diag(np.repeat([std_rad**2, std_m**2], 3))
        for observation in observations:
            yield observation
            if isinstance(observation, ImuSample) and observation.frame == "imu_cabin":
                k = round(100 * observation.stamp_s) - 5
                if k >= 10 and k % 10 == 0:
                    before, after = (
                        cabin.T_map_cabin(t) @ T_cabin_lidar for t in (k / 100 - 0.1, k / 100)
                    )
                    error = pose(exp_so3(rng.normal(0, std_rad, 3)), rng.normal(0, std_m, 3))
                    yield LidarIncrement(
                        k / 100 - 0.1, k / 100, LIDAR, inverse(before) @ after @ error, covariance
                    )

    return with_lidar


@pytest.fixture
def shifted():
    """Move or drop fixes."""

    def shifted(observations, shift_enu: Callable[[float], np.ndarray | None]):
        """Move each fix by what a function of time says; None drops it."""
        for observation in observations:
            if isinstance(observation, GnssFix):
                shift = shift_enu(observation.stamp_s)
                if shift is None:
                    continue
                datum = observation.geodetic
                observation = replace(
                    observation, geodetic=geodetic_from_enu(np.asarray(shift, dtype=float), datum)
                )
            yield observation

    return shifted


@pytest.fixture
def run():
    """Feed an estimator and look at it now and then."""

    def run(estimator, observations):
        """Feed all; return the states at every fifth cabin sample."""
        states = []
        for observation in observations:
            estimator.add(observation)
            is_cabin = isinstance(observation, ImuSample) and observation.frame == "imu_cabin"
            if is_cabin and round(100 * observation.stamp_s) % 5 == 0:
                states.append(estimator.state())
        return states

    return run


@pytest.fixture
def errors_m():
    """Hold states against the truth."""

    def errors_m(cabin, states, after_s=0.0):
        return np.array(
            [
                np.linalg.norm((s.T_map_cabin - cabin.T_map_cabin(s.stamp_s))[:3, 3])
                for s in states
                if s.is_ready and s.stamp_s >= after_s
            ]
        )

    return errors_m


@pytest.fixture
def reasons():
    """Pick the reasons of one kind of change."""

    def reasons(estimator, after):
        return [change.reason for change in estimator.changes if change.after == after]

    return reasons
