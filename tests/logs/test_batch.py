"""`--batch` on a machine's own log: two antennas, two inertial sensors, a turn joint."""

import numpy as np
import pytest

from executive.estimate.estimator_run import estimate
from executive.estimate.files import write_files
from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions
from executive.estimate.reference import with_reference
from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy, log_so3
from executive.logs.recorder import Recorder
from executive.machine.machine import load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample

DATUM = np.array([47.4084, 8.5106, 440.0])
TURN_RAD = 0.7
END_S = 7.0


@pytest.fixture(scope="module")
def machine():
    return load_machine("m545")


@pytest.fixture(scope="module")
def T_map_cabin():
    return pose(from_rpy(0.02, -0.03, 2.0), np.array([12.0, -5.0, 1.5]))


@pytest.fixture(scope="module")
def T_map_base(machine, T_map_cabin):
    turned = machine.joints[0].T_parent_joint @ pose(from_rpy(0.0, 0.0, TURN_RAD))
    return T_map_cabin @ inverse(turned)


@pytest.fixture(scope="module")
def log(machine, T_map_cabin, T_map_base, tmp_path_factory):
    """Seven seconds at rest; the cabin is turned on the chassis."""
    rng = np.random.default_rng(4)
    path = tmp_path_factory.mktemp("log") / "rest.mcap"
    recorder = Recorder(path, machine, "m545")
    position = np.zeros(len(machine.joint_names))
    position[0] = TURN_RAD
    for k in range(1, round(100 * END_S)):
        t = k / 100
        here = [JointSample(t, machine.joint_names, position, 0 * position, 0 * position)]
        for name, T in (("imu_base", T_map_base), ("imu_cabin", T_map_cabin)):
            R = (T @ machine.sensors[name].T_link_sensor)[:3, :3]
            force = R.T @ [0, 0, 9.81] + rng.normal(0, 0.02, 3)
            here.append(ImuSample(t, name, rng.normal(0, 0.002, 3), force))
        for name in ("gnss_left", "gnss_right") if k % 5 == 0 else ():
            p = (T_map_cabin @ machine.sensors[name].T_link_sensor)[:3, 3] + rng.normal(0, 0.008, 3)
            here.append(GnssFix(t, name, geodetic_from_enu(p, DATUM), 0.008**2 * np.eye(3), True))
        recorder.write(here, t)
    recorder.close()
    return path


def test_the_whole_log_gives_pose_and_heading_of_cabin_and_chassis(
    log, T_map_base, T_map_cabin, tmp_path
) -> None:
    options = EstimateOptions()
    material = Material.read(log, options)
    online = estimate(material, "dual_graph", options)
    estimated = with_reference(material, online, "batch_graph")
    reference = estimated.reference
    origin = T_map_base[:3, 3] - _origin(material)
    offset = reference.T_map_base[:, :3, 3] - origin
    assert np.linalg.norm(offset, axis=1).max() < 0.03
    turns = [log_so3(T[:3, :3] @ T_map_base[:3, :3].T) for T in reference.T_map_base]
    assert (
        np.abs(turns).max() < 0.01
    )  # heading by two antennas 1.9 m apart; with one there would be none at rest
    between = inverse(reference.T_map_base[-1]) @ reference.T_map_cabin[-1]
    np.testing.assert_allclose(between, inverse(T_map_base) @ T_map_cabin, atol=1e-6)
    assert estimated.report["reference"]["fixes_m"]["n"] > 150
    assert write_files(tmp_path / "way.tum", material, estimated)[-1].name == "way_smoothed.tum"


def _origin(material) -> np.ndarray:
    """The log's first fix, which is the smoother's datum, in the map of the test."""
    return enu_from_geodetic(material.datum, DATUM)
