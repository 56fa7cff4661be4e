"""A yard of planes, and a lidar that moves through it on a known path."""

from collections.abc import Callable

import numpy as np
import pytest

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.machine.machine import Machine, load_machine
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan

FRAME = "lidar_horizontal"
# Ground, walls of a yard and a block, as (normal, offset): n·p = d, the sensor's height at z = 0.
YARD = np.array(
    [
        [0, 0, 1, -2.0],
        [1, 0, 0, 12.0],
        [-1, 0, 0, 9.0],
        [0, 1, 0, 10.0],
        [0, -1, 0, 8.0],
        [0.6, 0.8, 0, 9.0],
    ]
)
Way = Callable[[float], np.ndarray]


class Yard:
    """Scans, inertial and joint samples of the machine whose cabin turns; the chassis may travel
    along x.
    """

    def __init__(
        self, planes: np.ndarray = YARD, rate_rad_s: float = 0.0, speed_m_s: float = 0.0
    ) -> None:
        self.machine: Machine = load_machine("m545")
        self._planes, self._rate, self._speed = planes, rate_rad_s, speed_m_s
        self._rng = np.random.default_rng(0)
        self._T_cabin_lidar = self.machine.sensors[FRAME].T_link_sensor

    def T_world_lidar(self, t: float) -> np.ndarray:
        """The lidar over an axis that travels; the world's origin is at the lidar's height."""
        T_world_cabin = pose(from_rpy(0, 0, self._rate * t), np.array([self._speed * t, 0, 0]))
        level = pose(t=np.array([0, 0, -self._T_cabin_lidar[2, 3]]))
        return level @ T_world_cabin @ self._T_cabin_lidar

    def T_from_to(self, from_s: float, to_s: float) -> np.ndarray:
        return inverse(self.T_world_lidar(from_s)) @ self.T_world_lidar(to_s)

    def imu(self, t: float) -> ImuSample:
        R_cabin_imu = self.machine.sensors["imu_cabin"].T_link_sensor[:3, :3]
        return ImuSample(t, "imu_cabin", R_cabin_imu.T @ [0, 0, self._rate], np.array([0, 0, 9.81]))

    def joints(self, t: float) -> JointSample:
        names = self.machine.joint_names
        q = np.concatenate([self.machine.posture("scan"), [0.0]])
        q[self.machine.arm_names.index("J_TURN")] = self._rate * t
        return JointSample(t, names, q, np.zeros(len(names)), np.zeros(len(names)))

    def scan(self, end_s: float, noise_m: float = 0.01) -> LidarScan:
        """One revolution of 0.1 s, each return cast from where the sensor is at its own time."""
        azimuth = np.repeat(np.arange(450) * 2 * np.pi / 450, 16)
        elevation = np.tile(np.radians(np.linspace(-15, 15, 16)), 450)
        stamps = end_s - 0.1 + 0.1 * np.repeat(np.arange(1, 451) / 450, 16)
        rays = np.c_[
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
        poses = np.array([self.T_world_lidar(t) for t in stamps[::16]]).repeat(16, axis=0)
        rays_world = np.einsum("nij,nj->ni", poses[:, :3, :3], rays)
        with np.errstate(divide="ignore", invalid="ignore"):
            ranges = (self._planes[:, 3] - poses[:, :3, 3] @ self._planes[:, :3].T) / (
                rays_world @ self._planes[:, :3].T
            )
        ranges = np.where(ranges > 0.1, ranges, np.inf).min(axis=1) + self._rng.normal(
            0, noise_m, len(rays)
        )
        seen = ranges < 50
        return LidarScan(end_s, FRAME, (rays * ranges[:, None])[seen], stamps[seen])

    def distances(self, points_world: np.ndarray) -> np.ndarray:
        """Of points to the nearest plane."""
        return np.abs(points_world @ self._planes[:, :3].T - self._planes[:, 3]).min(axis=1)


@pytest.fixture
def yard() -> type[Yard]:
    return Yard
