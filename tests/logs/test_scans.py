"""Scans in a log give the increments that the running machine would have had."""

from pathlib import Path

import numpy as np
import pytest

from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions, log_choices
from executive.geometry.geodesy import geodetic_from_enu
from executive.logs.recorder import Recorder
from executive.machine.machine import Machine, load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement

DATUM = np.array([47.4084, 8.5106, 440.0])
PLANES = np.array([[0, 0, -1, 2], [1, 0, 0, 11], [-1, 0, 0, 9], [0, 1, 0, 10], [0, -1, 0, 8]])


def scan(stamp_s: float) -> LidarScan:
    """A still revolution in a yard, returns spread over it."""
    azimuth, elevation = np.meshgrid(
        np.linspace(0, 2 * np.pi, 400, endpoint=False),
        np.radians(np.linspace(-15, 15, 16)),
        indexing="ij",
    )
    rays = np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=-1,
    ).reshape(-1, 3)
    with np.errstate(divide="ignore"):
        ranges = PLANES[:, 3] / (rays @ PLANES[:, :3].T)
    ranges = np.where(ranges > 0, ranges, np.inf).min(axis=1)
    ranges = ranges + np.random.default_rng(round(1000 * stamp_s)).normal(0, 0.01, len(ranges))
    stamps = np.repeat(np.linspace(stamp_s - 0.1, stamp_s, 400), 16)
    return LidarScan(stamp_s, "lidar_horizontal", rays * ranges[:, None], stamps)


def observations(machine: Machine, k: int) -> list:
    """What a still machine measures in the k-th hundredth of a second."""
    n = len(machine.joint_names)
    joints = np.concatenate([machine.posture("scan"), [0.0]])
    here = [
        ImuSample(0.01 * k, "imu_cabin", np.zeros(3), np.array([0, 0, 9.81])),
        JointSample(0.01 * k, machine.joint_names, joints, np.zeros(n), np.zeros(n)),
    ]
    if k % 10 == 0:
        fix = geodetic_from_enu(np.zeros(3), DATUM)
        here += [scan(0.01 * k), GnssFix(0.01 * k, "gnss_left", fix, 1e-4 * np.eye(3), True)]
    return here


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scans") / "still.mcap"
    machine = load_machine("m545")
    recorder = Recorder(path, machine, "m545")
    for k in range(1, 61):
        recorder.write(observations(machine, k), 0.01 * k)
    recorder.close()
    return path


@pytest.mark.parametrize("odometry", ["scan_to_submap", "kiss_icp"])
def test_scans_become_increments_of_a_machine_at_rest(log: Path, odometry: str) -> None:
    arrivals = Material.read(log, EstimateOptions(plugins=log_choices(odometry=odometry))).arrivals
    increments = [a.observation for a in arrivals if isinstance(a.observation, LidarIncrement)]
    assert len(increments) == 5
    for increment in increments:
        assert increment.to_s - increment.from_s == pytest.approx(0.1, abs=1e-3)
        np.testing.assert_allclose(increment.T_from_to, np.eye(4), atol=0.02)
    assert not any(isinstance(a.observation, LidarScan) for a in arrivals)


def test_without_an_odometry_scans_are_ignored(log: Path) -> None:
    arrivals = Material.read(log, EstimateOptions(plugins=log_choices(["odometry=[]"]))).arrivals
    assert {type(a.observation) for a in arrivals} == {ImuSample, JointSample, GnssFix}
