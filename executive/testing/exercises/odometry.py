"""Lidar odometry: a sensor at rest in a yard, and scans that show nothing."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.interfaces.odometry import LidarOdometry
from executive.machine.machine import Machine
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud

FRAME = "lidar_horizontal"
SCANS = 5


@cache
def scan(stamp_s: float) -> LidarScan:
    """Return a still revolution in a yard: ground, four walls, 1 cm of noise."""
    azimuth, elevation = np.meshgrid(
        np.linspace(0, 2 * np.pi, 400, endpoint=False), np.radians(np.linspace(-15, 15, 16))
    )
    directions = np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=-1,
    ).reshape(-1, 3)
    planes = np.array([[0, 0, -1, 2], [1, 0, 0, 11], [-1, 0, 0, 9], [0, 1, 0, 10], [0, -1, 0, 8]])
    with np.errstate(divide="ignore"):
        ranges = planes[:, 3] / (directions @ planes[:, :3].T)
    ranges = np.where(ranges > 0, ranges, np.inf).min(axis=1)
    ranges = ranges + np.random.default_rng(round(1000 * stamp_s)).normal(0, 0.01, len(ranges))
    return LidarScan(stamp_s, FRAME, directions * ranges[:, None], np.full(len(ranges), stamp_s))


class OdometryInputs(TypedDict):
    """The scans, and the joints of a machine that stands."""

    scans: tuple[LidarScan, ...]
    joints: JointSample


class OdometryExercise(Exercise[LidarOdometry, OdometryInputs]):
    """Half a second at rest."""

    def inputs(self, machine: Machine) -> OdometryInputs:
        position = np.append(machine.posture("scan"), 0.0)
        at_rest = np.zeros(len(position))
        joints = JointSample(0.0, machine.joint_names, position, at_rest, at_rest)
        return {"scans": tuple(scan(k / 10) for k in range(1, SCANS + 1)), "joints": joints}

    def run(self, plugin: LidarOdometry, inputs: OdometryInputs) -> object:
        plugin.add_joints(inputs["joints"])
        return [plugin.add_scan(one) for one in inputs["scans"]]

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[LidarOdometry], object]]:
        def after_one(*scans: LidarScan) -> Callable[[LidarOdometry], object]:
            return lambda plugin: [plugin.add_scan(one) for one in (scan(0.1), *scans)]

        def of(points: Float, stamp_s: float = 0.2, frame: str = FRAME) -> LidarScan:
            return LidarScan(stamp_s, frame, points, np.full(len(points), stamp_s))

        return {
            **with_each_cloud(
                lambda plugin, cloud: after_one(of(cloud.points))(plugin), "as a scan"
            ),
            **with_each_cloud(
                lambda plugin, cloud: plugin.add_scan(of(cloud.points)), "as the first scan"
            ),
            "a scan twice": after_one(scan(0.1)),
            "a scan out of order": after_one(of(np.array(scan(0.1).points_lidar), 0.05)),
            "an hour between two scans": after_one(of(np.array(scan(0.1).points_lidar), 3600.0)),
            "a scan of an unknown sensor": after_one(
                of(np.array(scan(0.1).points_lidar), 0.2, "lidar_of_another_machine")
            ),
        }
