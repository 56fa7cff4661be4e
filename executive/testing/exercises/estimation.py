"""Estimation: a machine at rest about the map's origin, and measurements that help nobody."""

from collections.abc import Callable, Iterator, Mapping
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import transform
from executive.interfaces.estimation import Estimator
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement
from executive.testing.exercise import Exercise

DATUM = np.array([47.4084, 8.5106, 440.0])  # latitude [deg], longitude [deg], altitude [m]
STANDARD_GRAVITY = np.array([0.0, 0.0, 9.81])  # specific force at rest [m/s²]
REST_S = 6.0


def rest(machine: Machine, duration_s: float = REST_S) -> Iterator[Observation]:
    """Yield the measurements of a machine that stands about the map's origin, free of noise."""
    frames = Kinematics(machine).frames(machine.posture("scan"))
    position = np.append(machine.posture("scan"), 0.0)
    for k in range(round(100 * duration_s)):
        t = k / 100
        for imu in machine.sensors_of("imu"):
            force = frames[imu.name][:3, :3].T @ STANDARD_GRAVITY
            yield ImuSample(t, imu.name, np.zeros(3), force)
        zeros = np.zeros((2, len(position)))
        yield JointSample(t, machine.joint_names, position.copy(), zeros[0], zeros[1])
        for antenna in machine.sensors_of("gnss") if k % 5 == 0 else ():
            geodetic = geodetic_from_enu(transform(frames[antenna.name], np.zeros(3)), DATUM)
            yield GnssFix(t, antenna.name, geodetic, np.eye(3) * 1e-4, True)


def T_map_cabin_at_rest(machine: Machine) -> Float:
    """Return where the cabin is while the machine stands."""
    return Kinematics(machine).frames(machine.posture("scan"))[machine.cabin_link]


def feed_rest(estimator: Estimator, machine: Machine) -> None:
    """Feed six seconds of rest."""
    for observation in rest(machine):
        estimator.add(observation)


class EstimationInputs(TypedDict):
    """What the sensors of a machine at rest measure."""

    observations: tuple[Observation | LidarIncrement, ...]


class EstimationExercise(Exercise[Estimator, EstimationInputs]):
    """Six seconds of rest, and one lidar increment."""

    def inputs(self, machine: Machine) -> EstimationInputs:
        increment = LidarIncrement(5.8, 5.9, "lidar_horizontal", np.eye(4), np.eye(6) * 1e-4)
        return {"observations": (*rest(machine), increment)}

    def run(self, plugin: Estimator, inputs: EstimationInputs) -> object:
        for observation in inputs["observations"]:
            plugin.add(observation)
        return plugin.state(), tuple(plugin.account())

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[Estimator], object]]:
        imu = machine.sensors_of("imu")[0].name

        def fed(*stream: Observation | LidarIncrement) -> Callable[[Estimator], object]:
            def call(estimator: Estimator) -> object:
                for observation in stream:
                    estimator.add(observation)
                return estimator.state()

            return call

        def sample(stamp_s: float, frame: str = imu) -> ImuSample:
            return ImuSample(stamp_s, frame, np.ones(3), np.ones(3))

        def fix(stamp_s: float, antenna: str) -> GnssFix:
            return GnssFix(stamp_s, antenna, DATUM + 1.0, np.eye(3) * 1e-4, True)

        return {
            "no measurement": fed(),
            "one inertial sample": fed(sample(0.0)),
            "a sample twice": fed(sample(0.0), sample(0.0)),
            "a sample out of order": fed(sample(1.0), sample(0.5)),
            "a stamp that is not a number": fed(sample(0.0), sample(float("nan"))),
            "an hour between two samples": fed(sample(0.0), sample(3600.0)),
            "a sample of an unknown sensor": fed(sample(0.0, "imu_of_another_machine")),
            "a fix of an unknown antenna": fed(fix(0.0, "antenna_of_another_machine")),
            "an increment before anything else": fed(
                LidarIncrement(0.0, 0.1, "lidar_horizontal", np.eye(4), np.eye(6) * 1e-4)
            ),
        }
