"""A machine that swings in a yard of planes, and its lidar scans with motion distortion."""

from collections.abc import Callable

import numpy as np
import pytest

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion

Z = np.array([0.0, 0.0, 1.0])
# n·p = d, n away from the yard: ground 1.5 m below the cabin, two walls
PLANES = np.array([[0, 0, -1, 0.0], [1, 0, 0, 7.0], [0, 1, 0, 6.0]])
REVOLUTION_S = 0.1


@pytest.fixture(scope="session")
def machine() -> Machine:
    return load_machine("m545")


class Yard:
    """Scans of planes from a cabin that turns at a rate [rad/s]."""

    def __init__(self, machine: Machine, rate_rad_s: float, noise_m: float = 0.0) -> None:
        self.machine, self.rate_rad_s = machine, rate_rad_s
        self.rng, self.noise_m = np.random.default_rng(0), noise_m
        q = machine.posture("scan")
        self.joints = np.append(q, 0.0)
        frames = Kinematics(machine).frames(q)
        self.T_cabin = {name: inverse(frames[machine.cabin_link]) @ T for name, T in frames.items()}

    def T_map_cabin(self, stamp_s: float) -> Float:
        return pose(about_axis(Z, 0.3 + self.rate_rad_s * stamp_s), np.array([0.2, -0.1, 1.5]))

    def motion(self, until_s: float) -> Motion:
        """The estimate's samples at 50 Hz around a scan; the turn joint turns with the cabin."""
        stamps = until_s + np.arange(-0.16, 0.021, 0.02)
        joints = np.repeat(self.joints[None], len(stamps), axis=0)
        joints[:, self.machine.joint_names.index(self.machine.turn_joint)] = (
            self.rate_rad_s * stamps
        )
        return Motion(
            stamps,
            np.array([self.T_map_cabin(s) for s in stamps]),
            self.machine.joint_names,
            joints,
        )

    def scan(self, lidar: str, stamp_s: float, columns: int = 900) -> LidarScan:
        """One revolution that ends at a time, each column with the pose of its own time."""
        elevation = np.radians(np.linspace(-15, 15, 16))
        points, stamps = [], []
        for k in range(columns):
            t = stamp_s - REVOLUTION_S * (1 - (k + 1) / columns)
            a = 2 * np.pi * k / columns
            d = np.column_stack(
                [np.cos(elevation) * np.cos(a), np.cos(elevation) * np.sin(a), np.sin(elevation)]
            )
            T = self.T_map_cabin(t) @ self.T_cabin[lidar]
            rises = (d @ T[:3, :3].T) @ PLANES[:, :3].T
            ranges = np.where(
                rises > 1e-6,
                (PLANES[:, 3] - PLANES[:, :3] @ T[:3, 3]) / np.maximum(rises, 1e-6),
                np.inf,
            )
            nearest = ranges.min(axis=1)
            hit = (nearest > 1.0) & (nearest < 30)
            points.append(
                d[hit] * (nearest[hit] + self.rng.normal(0, self.noise_m, hit.sum()))[:, None]
            )
            stamps.append(np.full(hit.sum(), t))
        return LidarScan(stamp_s, lidar, np.vstack(points), np.concatenate(stamps))

    def pair(self, stamp_s: float) -> list[LidarScan]:
        return [self.scan("lidar_vertical", stamp_s), self.scan("lidar_horizontal", stamp_s - 0.03)]

    def as_scan(self, points_cabin: Float, lidar: str, stamp_s: float = 1.0) -> LidarScan:
        """Given points as one lidar would return them, all at one time."""
        seen = transform(inverse(self.T_cabin[lidar]), points_cabin)
        return LidarScan(stamp_s, lidar, seen, np.full(len(seen), stamp_s))


@pytest.fixture(scope="session")
def make_yard(machine: Machine) -> Callable[..., Yard]:
    return lambda rate_rad_s, noise_m=0.0: Yard(machine, rate_rad_s, noise_m)


def plane_distances(points: Float) -> Float:
    """Return the distance of each point to the nearest plane of the yard [m]."""
    return np.asarray(np.abs(points @ PLANES[:, :3].T - PLANES[:, 3]).min(axis=1))


@pytest.fixture(scope="session")
def off_planes() -> Callable[[Float], Float]:
    return plane_distances
