"""The voxel map, in a yard of planes and on the machine itself."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.mapping.settings import VoxelMapSettings
from executive_plugins.mapping.voxel_map import VoxelMap

from executive.errors import ConfigError, DataError
from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion


@pytest.fixture
def make_map(machine: Machine) -> Callable[..., VoxelMap]:
    def make(**settings: float) -> VoxelMap:
        mapper = VoxelMap(VoxelMapSettings(**settings), machine)
        mapper.start()
        return mapper

    return make


def test_planes_stay_planes_while_the_cabin_swings(
    make_map: Callable, make_yard: Callable, off_planes: Callable
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.35), make_map(min_points=1)
    for k in range(6):
        mapper.add_scan_pair(yard.pair(1 + 0.1 * k), yard.motion(1 + 0.1 * k))
    points = mapper.cloud().points
    assert len(points) > 20_000
    distances = np.sort(off_planes(points))
    assert distances[-1] < 0.03  # in the corners a voxel averages over two planes
    assert (
        distances[int(0.99 * len(points))] < 1e-4
    )  # a scan taken as one instant would be 25 cm off at 7 m
    centre = yard.T_map_cabin(1.0)[:2, 3]
    assert np.linalg.norm(points[:, :2] - centre, axis=1).max() < 10.0


def test_without_motion_correction_planes_are_distorted(
    make_yard: Callable, make_map: Callable, off_planes: Callable
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.35), make_map(min_points=1)
    motion = yard.motion(1.0)
    still = Motion(
        motion.stamps_s[-1:],
        motion.T_map_cabin[-1:],
        motion.joint_names,
        motion.joint_position[-1:],
    )
    mapper.add_scan_pair(yard.pair(1.0), still)
    assert off_planes(mapper.cloud().points).max() > 0.1


def test_noise_is_smoothed(make_map: Callable, make_yard: Callable, off_planes: Callable) -> None:
    yard = make_yard(rate_rad_s=0.1, noise_m=0.02)
    raw, smooth = make_map(smoothing_m=0.0), make_map()
    for k in range(12):
        for mapper in (raw, smooth):
            mapper.add_scan_pair(yard.pair(1 + 0.1 * k), yard.motion(1 + 0.1 * k))
    assert len(smooth.cloud()) < len(raw.cloud())  # fewer layers
    assert np.mean(off_planes(smooth.cloud().points)) < 0.8 * np.mean(
        off_planes(raw.cloud().points)
    )


@pytest.mark.parametrize("posture", ["scan", "carry"])
def test_the_machine_does_not_map_itself(
    make_map: Callable, make_yard: Callable, machine: Machine, posture: str
) -> None:
    yard = make_yard(rate_rad_s=0.0)
    joints = np.append(machine.posture(posture), 0.4)
    frames = Kinematics(machine).frames(joints[:-1], 0.4)
    on_links = [
        transform(
            frames[name],
            shape.vertices[
                np.random.default_rng(0).integers(len(shape.vertices), size=(60, 3))
            ].mean(axis=1),
        )
        for name, link in machine.links.items()
        for shape in link.shapes
    ]
    T_cabin_base = np.linalg.inv(frames[machine.cabin_link])
    scan = yard.as_scan(transform(T_cabin_base, np.vstack(on_links)), "lidar_horizontal")
    motion = Motion(np.ones(1), yard.T_map_cabin(1.0)[None], machine.joint_names, joints[None])
    assert make_map(nearest_m=0.0).add_scan_pair([scan], motion) == 0


def test_the_filter_follows_the_joints(
    make_map: Callable, make_yard: Callable, machine: Machine
) -> None:
    yard = make_yard(rate_rad_s=0.0)
    raised, lowered = (
        np.append(machine.posture("scan"), 0.0),
        np.append(machine.posture("scan"), 0.0),
    )
    raised[machine.joint_names.index("J_BOOM")], lowered[machine.joint_names.index("J_BOOM")] = (
        1.2,
        0.2,
    )
    frames = Kinematics(machine).frames(raised[:-1])
    elbow = transform(
        np.linalg.inv(frames[machine.cabin_link]) @ frames["dipper"],
        np.array([[0.0, 0, 0], [0, 0, -0.5]]),
    )
    scan = yard.as_scan(elbow, "lidar_horizontal")
    T = yard.T_map_cabin(1.0)[None]
    assert (
        make_map().add_scan_pair([scan], Motion(np.ones(1), T, machine.joint_names, raised[None]))
        == 0
    )
    assert (
        make_map().add_scan_pair([scan], Motion(np.ones(1), T, machine.joint_names, lowered[None]))
        == 2
    )


def test_what_lies_behind_a_link_is_a_shadow(
    make_map: Callable, make_yard: Callable, machine: Machine
) -> None:
    yard = make_yard(rate_rad_s=0.0)
    sensor, dipper = yard.T_cabin["lidar_horizontal"][:3, 3], yard.T_cabin["dipper"]
    vertices = np.vstack([shape.vertices for shape in machine.links["dipper"].shapes])
    through = transform(dipper, 0.5 * (vertices.min(axis=0) + vertices.max(axis=0)))
    way = (through - sensor) / np.linalg.norm(through - sensor)
    length_m = np.linalg.norm(through - sensor)
    behind = sensor + np.outer([length_m + 2.0, length_m + 4.0], way)
    beside = sensor + np.array([[1.0, 4.0, 1.0], [1.0, 6.0, 1.0]])  # to the left, away from the arm
    scan = yard.as_scan(np.vstack([behind, beside]), "lidar_horizontal")
    assert make_map().add_scan_pair([scan], yard.motion(1.0)) == 2
    assert make_map(shadow_m=0.0).add_scan_pair([scan], yard.motion(1.0)) == 4


def test_a_held_stone_is_masked_only_while_it_is_held(
    make_map: Callable, make_yard: Callable, machine: Machine
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.0), make_map()
    d = np.random.default_rng(0).normal(size=(500, 3))
    stone_gripper = machine.gripper.grasp_centre + 0.7 * d / np.linalg.norm(d, axis=1)[:, None]
    scan = yard.as_scan(transform(yard.T_cabin["gripper"], stone_gripper), "lidar_horizontal")
    seen = mapper.add_scan_pair([scan], yard.motion(1.0))
    mapper.mask_held(0.75)
    masked = mapper.add_scan_pair([scan], yard.motion(1.0))
    mapper.mask_held(0.0)
    assert (masked, mapper.add_scan_pair([scan], yard.motion(1.0))) == (0, seen)
    assert seen > 250


def test_a_removed_sphere_stays_empty_until_it_is_seen_again(
    make_map: Callable, make_yard: Callable
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.0), make_map(min_points=1, smoothing_m=0.0)
    mapper.add_scan_pair(yard.pair(1.0), yard.motion(1.0))
    before = mapper.cloud().points
    centre = before[np.argmin(np.linalg.norm(before - [5, 2, 0], axis=1))]
    near = np.linalg.norm(before - centre, axis=1) <= 1.0
    assert mapper.remove_sphere(centre, 1.0) == near.sum() > 20
    np.testing.assert_array_equal(mapper.cloud().points, before[~near])
    mapper.add_scan_pair(yard.pair(1.1), yard.motion(1.1))
    assert (np.linalg.norm(mapper.cloud().points - centre, axis=1) <= 1.0).sum() > 20


def test_the_cylinder_follows_a_machine_that_drives(make_map: Callable, machine: Machine) -> None:
    mapper = make_map(min_points=1, radius_m=5.0)
    names, joints = machine.joint_names, np.append(machine.posture("scan"), 0.0)[None]
    d = np.random.default_rng(0).normal(size=(3000, 3))
    scan = LidarScan(
        1.0, "lidar_horizontal", 4 * d / np.linalg.norm(d, axis=1)[:, None], np.ones(3000)
    )
    for x in (0.0, 20.0):
        T = np.eye(4)
        T[0, 3] = x
        mapper.add_scan_pair([scan], Motion(np.ones(1), T[None], names, joints))
    assert mapper.cloud().points[:, 0].min() > 14


def test_errors_of_bad_input_name_the_cause(
    make_map: Callable, make_yard: Callable, machine: Machine
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.0), make_map()
    scan = yard.as_scan(np.full((3, 3), 4.0), "lidar_horizontal")
    with pytest.raises(DataError, match=r"'lidar_top'.*there is|Did you mean"):
        mapper.add_scan_pair(
            [LidarScan(1.0, "lidar_top", scan.points_lidar, scan.point_stamps_s)], yard.motion(1.0)
        )
    lame = Motion(np.ones(1), np.eye(4)[None], ("J_TURN",), np.zeros((1, 1)))
    with pytest.raises(DataError, match="lacks joint J_BOOM"):
        mapper.add_scan_pair([scan], lame)
    with pytest.raises(DataError, match="not be negative"):
        mapper.mask_held(-1.0)
    with pytest.raises(ConfigError, match="not started"):
        VoxelMap(VoxelMapSettings(), machine).cloud()
