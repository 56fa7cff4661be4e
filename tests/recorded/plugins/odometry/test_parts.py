"""The parts of lidar odometry: paths, dead reckoning, planes and fits to them."""

import numpy as np
import pytest
from executive_plugins.odometry.dead_reckoning import DeadReckoning
from executive_plugins.odometry.own_returns import OwnReturns
from executive_plugins.odometry.plane_fit import Guess, fit
from executive_plugins.odometry.plane_map import PlaneMap
from executive_plugins.odometry.sensor_path import SensorPath

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement

FRAME = "lidar_horizontal"


def turned(k: float) -> np.ndarray:
    return pose(exp_so3(np.array([0.01, -0.02, 0.1]) * k), np.array([0.3, 0.1, -0.05]) * k)


def test_paths(recorded) -> None:
    stamps = np.array([1.0, 1.25, 1.5, 2.0])
    path = SensorPath.of(stamps, np.array([turned(k**2) for k in range(4)]))
    points = np.random.default_rng(1).normal(0, 3, (9, 3))
    told = [path.T_end_then(t) for t in (0.0, 1.0, 1.1, 1.75, 2.0, 3.0)]
    recorded((path, told, path.undistort(points, np.linspace(0.9, 2.1, 9))))


def joints(machine, stamp_s: float, turn_rad: float) -> JointSample:
    names, zeros = machine.joint_names, np.zeros(len(machine.joint_names))
    q = zeros.copy()
    q[machine.arm_names.index(machine.turn_joint)] = turn_rad
    return JointSample(stamp_s, names, q, zeros, zeros)


@pytest.mark.parametrize("fresh_until_s", [0.0, 0.4, 0.75, 2.0])
def test_dead_reckoning(recorded, machine, fresh_until_s) -> None:
    reckoning, told = DeadReckoning(machine, FRAME), []
    P = np.diag([1e-6, 2e-6, 3e-6, 1e-4, 2e-4, 3e-4])
    for k in range(20):
        t = k / 16
        if t <= fresh_until_s:
            rate = np.array([0.1, -0.2, 0.5 + 0.1 * np.sin(k)])
            reckoning.add_imu(ImuSample(t, "imu_cabin", rate, np.ones(3)))
            reckoning.add_imu(ImuSample(t, "imu_base", -rate, np.ones(3)))
            reckoning.add_joints(joints(machine, t, 0.4 * t))
            reckoning.add_joints(joints(machine, t - 0.01, 9.0))
        told.append(reckoning.path(t - 0.25, t))
        if k % 4 == 3:
            reckoning.correct(LidarIncrement(t - 0.25, t, FRAME, turned(0.2 + 0.01 * k), P))
    recorded(told)


def test_samples_are_kept_for_three_seconds(recorded, machine) -> None:
    reckoning = DeadReckoning(machine, FRAME)
    for k in range(9):
        rate = np.array([0.0, 0.0, float(k)])
        reckoning.add_imu(ImuSample(k / 2, "imu_cabin", rate, np.ones(3)))
        reckoning.add_joints(joints(machine, k / 2, float(k)))
    reckoning.correct(LidarIncrement(0.5, 1.0, FRAME, turned(1), np.eye(6) * 1e-4))
    recorded([reckoning.path(t, 4.0) for t in (0.0, 0.5, 1.0, 1.5)])


def test_own_returns(recorded, machine) -> None:
    own = OwnReturns(machine)
    points = np.random.default_rng(2).uniform(-4, 6, (400, 3))
    scan = LidarScan(1.0, FRAME, points, np.ones(400))
    none = own.among(scan)
    own.add_joints(joints(machine, 1.0, 0.3))
    empty = own.among(LidarScan(1.0, FRAME, points[:0], np.ones(0)))
    recorded((none.sum(), own.among(scan).tolist(), empty))


def room(seed: int, count: int = 400) -> np.ndarray:
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-3, 3, (2, count))
    return np.vstack([np.c_[u, v, 0 * u], np.c_[u, 0 * u + 3, v + 3], np.c_[0 * u - 3, u, v + 3]])


@pytest.mark.parametrize("most_scans", [1, 3])
def test_plane_maps(recorded, most_scans) -> None:
    planes, told = PlaneMap(0.25, 0.75, 12, most_scans), []
    told.append(planes.nearest(room(0)[:5], 0.5))
    for k in (0, 0, 1, 3, 2):
        planes.add(turned(k), transform(np.linalg.inv(turned(k)), room(k)))
        told += [planes.planes, planes.nearest(room(9)[::40], 0.125)]
        told += [planes.is_new(turned(s), 0.5, 0.2) for s in (0.0, 1.25, 2.5, 4.5)]
    few = PlaneMap(0.25, 0.75, 12, 1)
    few.add(np.eye(4), room(1)[:5])
    told += [few.planes.points, few.nearest(room(1)[:3], 1.0)]
    recorded(told)


@pytest.mark.parametrize("noise_m", [0.0, 0.02])
def test_fits(recorded, noise_m) -> None:
    planes = PlaneMap(0.25, 0.75, 12, 3)
    planes.add(np.eye(4), room(1, 900))
    rng, told = np.random.default_rng(3), []
    std = np.array([0.005] * 3 + [0.02] * 3)
    scan = transform(np.linalg.inv(turned(0.3)), room(2)) + rng.normal(0, noise_m, (1200, 3))
    for points, start, first_m in (
        (scan, 0.3, 1.0),
        (scan, 0.5, 1.0),
        (scan, 1.5, 0.5),
        (scan[:400], 0.4, 1.0),  # the ground alone
        (scan + 50.0, 0.3, 1.0),  # nothing near
    ):
        told.append(fit(points, planes, Guess(turned(start), std), first_m, 0.3))
    # A step that alternates between correspondences ends where its size decides.
    recorded(told, relative=1e-6)
