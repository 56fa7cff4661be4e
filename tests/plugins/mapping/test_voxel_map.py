"""The voxel map, in a yard of planes and on the machine itself."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from executive_plugins.mapping.carving import Carver
from executive_plugins.mapping.column_store import Columns
from executive_plugins.mapping.column_surface import Choice
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.pose_graph import PoseGraph
from executive_plugins.mapping.scan_front_end import ScanFrontEnd
from executive_plugins.mapping.settings import PoseGraphSettings, VoxelMapSettings
from executive_plugins.mapping.voxel_map import VoxelMap

from executive.arrays import Float
from executive.errors import ConfigError, DataError
from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
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


@pytest.mark.parametrize("slid_m", [0.0, 0.35])
def test_a_held_stone_is_masked_only_while_it_is_held(
    make_map: Callable, make_yard: Callable, machine: Machine, slid_m: float
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.0), make_map()
    d = np.random.default_rng(0).normal(size=(500, 3))
    stone_gripper = machine.gripper.grasp_centre + 0.7 * d / np.linalg.norm(d, axis=1)[:, None]
    stone_gripper += (
        slid_m * machine.gripper.grasp_centre / np.linalg.norm(machine.gripper.grasp_centre)
    )  # away from the palm
    scan = yard.as_scan(transform(yard.T_cabin["gripper"], stone_gripper), "lidar_horizontal")
    seen = mapper.add_scan_pair([scan], yard.motion(1.0))
    mapper.mask_held(0.75)
    masked = mapper.add_scan_pair([scan], yard.motion(1.0))
    mapper.mask_held(0.0)
    assert (masked, mapper.add_scan_pair([scan], yard.motion(1.0))) == (0, seen)
    assert seen > 250


@pytest.mark.parametrize("plugin", ["voxel_map", "pose_graph"])
def test_what_is_held_is_seen_in_the_frame_of_the_gripper(
    make_yard: Callable, machine: Machine, plugin: str
) -> None:
    yard = make_yard(rate_rad_s=0.0)
    mapper = (
        VoxelMap(VoxelMapSettings(), machine)
        if plugin == "voxel_map"
        else PoseGraph(PoseGraphSettings(process=False), machine)
    )
    mapper.start()
    d = np.random.default_rng(0).normal(size=(500, 3))
    stone = machine.gripper.grasp_centre + 0.7 * d / np.linalg.norm(d, axis=1)[:, None]
    scan = yard.as_scan(transform(yard.T_cabin["gripper"], stone), "lidar_horizontal")
    mapper.add_scan_pair([scan], yard.motion(1.0))
    assert len(mapper.held()) == 0  # nothing is held yet
    mapper.mask_held(0.75)
    mapper.add_scan_pair([scan, yard.scan("lidar_horizontal", 1.0)], yard.motion(1.0))
    seen = mapper.held()
    assert seen.frame == "gripper"
    assert 200 < len(seen) < 500  # but for what is in the machine's links, or in their shadow
    away = np.linalg.norm(seen.points[:, None] - stone[None], axis=2).min(axis=1)
    assert away.max() < 0.03  # a voxel
    mapper.mask_held(0.0)
    assert len(mapper.held()) == 0
    mapper.close()


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


def test_scan_pairs_do_not_wait_for_a_thread_that_reads_the_map(
    make_map: Callable, make_yard: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    yard, mapper, alone = make_yard(rate_rad_s=0.35), make_map(), make_map()
    begun, go_on, read = threading.Event(), threading.Event(), MapCloud.read

    def slowly(self: MapCloud, columns: Columns, choice: Choice) -> Cloud:
        begun.set()
        assert go_on.wait(60.0)
        return read(self, columns, choice)

    for k in range(3):
        mapper.add_scan_pair(yard.pair(1 + 0.1 * k), yard.motion(1 + 0.1 * k))
        alone.add_scan_pair(yard.pair(1 + 0.1 * k), yard.motion(1 + 0.1 * k))
    before = alone.cloud().points
    monkeypatch.setattr(MapCloud, "read", slowly)
    found: list[Cloud] = []
    reader = threading.Thread(target=lambda: found.append(mapper.cloud()), daemon=True)
    reader.start()
    assert begun.wait(60.0)
    mapper.add_scan_pair(yard.pair(1.3), yard.motion(1.3))  # would wait for ever
    mapper.remove_sphere(np.array([4.0, 0.0, 0.0]), 0.5)
    go_on.set()
    reader.join()
    alone.add_scan_pair(yard.pair(1.3), yard.motion(1.3))
    alone.remove_sphere(np.array([4.0, 0.0, 0.0]), 0.5)
    np.testing.assert_array_equal(found[0].points, before)
    np.testing.assert_array_equal(mapper.cloud().points, alone.cloud().points)
    assert len(mapper.cloud()) != len(before)


def test_a_pair_that_is_under_way_when_the_jaws_hold_something_else_adds_nothing_to_it(
    make_map: Callable, make_yard: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.0), make_map()
    place = ScanFrontEnd.place_held
    mapper.mask_held(3.0)
    mapper.add_scan_pair(yard.pair(1.0), yard.motion(1.0))
    assert len(mapper.held())

    def released(self: ScanFrontEnd, *given: Any) -> Float:
        mapper.mask_held(0.0)  # by the tick, while the thread fuses
        return place(self, *given)

    monkeypatch.setattr(ScanFrontEnd, "place_held", released)
    mapper.add_scan_pair(yard.pair(1.1), yard.motion(1.1))
    assert not len(mapper.held())


def test_a_pair_waits_for_a_surface_that_the_tick_adds(
    make_map: Callable, make_yard: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    yard = make_yard(rate_rad_s=0.0)
    mapper, alone = make_map(forget_after=3), make_map(forget_after=3)
    surface = np.array([[4.0, 0.0, 0.5], [4.1, 0.0, 0.5]])
    begun, go_on, add = threading.Event(), threading.Event(), Carver.add

    def slowly(self: Carver, points_map: Float) -> None:
        begun.set()
        assert go_on.wait(60.0)
        add(self, points_map)

    for one in (mapper, alone):
        one.add_scan_pair(yard.pair(1.0), yard.motion(1.0))
    alone.add_surface(surface)
    alone.add_scan_pair(yard.pair(1.1), yard.motion(1.1))
    monkeypatch.setattr(Carver, "add", slowly)
    adding = threading.Thread(target=lambda: mapper.add_surface(surface), daemon=True)
    fusing = threading.Thread(
        target=lambda: mapper.add_scan_pair(yard.pair(1.1), yard.motion(1.1)), daemon=True
    )
    adding.start()
    assert begun.wait(60.0)
    fusing.start()
    fusing.join(1.0)  # longer than it takes alone
    assert fusing.is_alive()
    go_on.set()
    for thread in (adding, fusing):
        thread.join(60.0)
    np.testing.assert_array_equal(mapper.cloud().points, alone.cloud().points)


def test_a_map_that_is_restored_goes_on_like_the_one_that_was_kept(
    make_map: Callable, make_yard: Callable
) -> None:
    """Also one that forgets: rays of later scans clear the restored voxels."""
    yard, kept = make_yard(rate_rad_s=0.0), make_map(min_points=1, forget_after=2, radius_m=6.0)
    scan = yard.scan("lidar_vertical", 1.0, 120)
    kept.add_scan_pair([scan], yard.motion(1.0))
    before = len(kept.cloud())
    # Something that stands in the way of the rays to the ground, and is gone.
    gone = kept.cloud().points[::9] * 0.8 + 0.2 * yard.T_map_cabin(1.0)[:3, 3]
    kept.add_surface(gone)
    kept.mask_held(0.75)
    other = make_map(min_points=1, forget_after=2, radius_m=6.0)
    stale = other.cloud()
    revision = other.revision
    assert len(stale) == 0
    other.restore(kept.keep())
    assert other.revision > revision
    np.testing.assert_array_equal(other.cloud().points, kept.cloud().points)
    assert len(other.cloud()) > before
    for k in range(3):
        stamp_s = 1.1 + 0.1 * k
        pair = [yard.scan("lidar_vertical", stamp_s, 120)]
        added = [one.add_scan_pair(pair, yard.motion(stamp_s)) for one in (kept, other)]
        assert added[0] == added[1]
    np.testing.assert_array_equal(other.cloud().points, kept.cloud().points)
    assert other.forgotten == kept.forgotten
    assert other.forgotten > 0
    np.testing.assert_array_equal(other.held().points, kept.held().points)
    (kept_here, kept_there) = kept.keep(), other.keep()
    assert kept_here["held_radius_m"] == kept_there["held_radius_m"] == 0.75
    np.testing.assert_array_equal(kept_here["centre_map"], kept_there["centre_map"])


def stood_before(scan: LidarScan, range_m: float) -> LidarScan:
    """Return a scan of which the rays within 0.15 rad of ahead end on something."""
    points = scan.points_lidar.copy()
    ahead = np.abs(np.arctan2(points[:, 1], points[:, 0])) < 0.15
    points[ahead] *= range_m / np.linalg.norm(points[ahead], axis=1)[:, None]
    return LidarScan(scan.stamp_s, scan.frame, points, scan.point_stamps_s)


@pytest.mark.parametrize(("settings", "moves"), [({}, True), ({"forget_after": 0}, False)])
def test_what_steps_before_a_wall_moves_where_the_map_forgets(
    make_map: Callable, make_yard: Callable, settings: dict[str, int], moves: bool
) -> None:
    yard, mapper = make_yard(rate_rad_s=0.0), make_map(**settings)
    for k in range(30):
        mapper.add_scan_pair(yard.pair(1 + 0.1 * k), yard.motion(1 + 0.1 * k))
    wall = mapper.cloud().points
    assert mapper.moving().share(wall) < 0.01
    first, second = yard.pair(4.0)
    mapper.add_scan_pair([stood_before(first, 3.0), second], yard.motion(4.0))
    grown = mapper.add_scan_pair([stood_before(first, 3.0), second], yard.motion(4.0))
    assert grown > 0
    points = mapper.cloud().points
    own = points[mapper.moving().hold(points)]
    assert (len(own) > 100) == moves
    distances_m = np.linalg.norm(own - yard.T_map_cabin(4.0)[:3, 3], axis=1)
    assert (distances_m < 5.0).all()


def test_a_map_that_is_not_started_tells_nothing_that_moves(machine: Machine) -> None:
    with pytest.raises(ConfigError, match="not started"):
        VoxelMap(VoxelMapSettings(), machine).moving()
