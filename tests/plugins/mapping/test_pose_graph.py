"""The pose graph's map: matches correct a poor estimate, and memory is bounded."""

import threading
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.pose_graph import PoseGraph
from executive_plugins.mapping.settings import PoseGraphSettings, VoxelMapSettings
from executive_plugins.mapping.voxel_map import VoxelMap

from executive.errors import ConfigError, DataError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion

RATE_RAD_S = 0.35
COARSE = {"voxel_m": 0.1, "smoothing_m": 0.0}  # for scans of few columns


@pytest.fixture
def make_graph(machine: Machine, request: pytest.FixtureRequest) -> Callable[..., PoseGraph]:
    def make(**settings: object) -> PoseGraph:
        mapper = PoseGraph(PoseGraphSettings.model_validate(settings), machine)
        mapper.start()
        request.addfinalizer(mapper.close)
        return mapper

    return make


def shaken(
    motion: Motion, rng: np.random.Generator, rotation_rad: float, position_m: float
) -> Motion:
    """An estimate that is off by an error which is another one for each pair."""
    error = pose(exp_so3(rng.normal(0, rotation_rad, 3)), rng.normal(0, position_m, 3))
    covariance = np.diag(np.repeat([rotation_rad**2, position_m**2], 3))
    return Motion(
        motion.stamps_s,
        motion.T_map_cabin @ error,
        motion.joint_names,
        motion.joint_position,
        covariance,
    )


def told(motion: Motion, position_m: float) -> Motion:
    """The same, and how surely it is known."""
    return replace(motion, covariance=np.diag(np.repeat([1e-3**2, position_m**2], 3)))


def quick(yard: Any, stamp_s: float, columns: int = 90) -> list[LidarScan]:
    """A pair of few columns."""
    return [
        yard.scan("lidar_vertical", stamp_s, columns),
        yard.scan("lidar_horizontal", stamp_s - 0.03, columns),
    ]


def test_planes_stay_planes_while_the_cabin_swings(
    make_graph: Callable, make_yard: Callable, off_planes: Callable
) -> None:
    yard, mapper = make_yard(RATE_RAD_S), make_graph(min_points=1)
    for k in range(3):
        mapper.add_scan_pair(yard.pair(1 + 0.1 * k), yard.motion(1 + 0.1 * k))
    distances = np.sort(off_planes(mapper.cloud().points))
    assert len(distances) > 15_000
    assert distances[-1] < 0.03
    assert distances[int(0.99 * len(distances))] < 1e-3


def test_matches_correct_an_estimate_with_random_errors(
    make_graph: Callable, make_yard: Callable, off_planes: Callable, machine: Machine
) -> None:
    yard, rng = make_yard(RATE_RAD_S, noise_m=0.01), np.random.default_rng(0)
    jumpy = {
        "rotation_rad": 0.03,
        "position_m": 0.15,
        "correlation_s": 0.05,
        "anchor_period_s": 0.1,
    }
    graph = make_graph(odometry=jumpy, **COARSE)
    voxels = VoxelMap(VoxelMapSettings.model_validate(COARSE), machine)
    voxels.start()
    for k in range(25):
        scans, motion = quick(yard, 1 + 0.1 * k), shaken(yard.motion(1 + 0.1 * k), rng, 0.008, 0.04)
        for mapper in (graph, voxels):
            mapper.add_scan_pair(scans, motion)
    matched, averaged = (off_planes(mapper.cloud().points) for mapper in (graph, voxels))
    assert np.median(matched) < 0.75 * np.median(averaged)


def test_pairs_at_rest_make_no_node_and_the_first_few_are_mapped(
    make_graph: Callable, make_yard: Callable
) -> None:
    yard, mapper = make_yard(0.0), make_graph(pairs_at_rest=3, **COARSE)
    sizes = []
    for k in range(6):
        mapper.add_scan_pair(quick(yard, 1 + 0.1 * k), yard.motion(1 + 0.1 * k))
        sizes.append(mapper.cloud())
    assert len(sizes[1]) > len(sizes[0])  # two returns make a voxel
    assert [np.array_equal(a.points, b.points) for a, b in pairwise(sizes[2:])] == [True] * 3


def test_a_removed_stone_stays_removed_when_later_fixes_move_the_map(
    make_graph: Callable, make_yard: Callable
) -> None:
    yard, mapper = make_yard(RATE_RAD_S), make_graph(min_points=1, **COARSE)
    d = np.random.default_rng(0).normal(size=(800, 3))
    stone_map = 0.4 * d / np.linalg.norm(d, axis=1)[:, None] + [5.0, 2.0, 0.6]

    def stone_or_ghost() -> int:
        points = mapper.cloud().points
        return int((np.linalg.norm(points - [5.0, 2.0, 0.65], axis=1) < 0.55).sum())

    for k in range(5):
        stamp_s = 1 + 0.1 * k
        stone = yard.as_scan(
            transform(inverse(yard.T_map_cabin(stamp_s)), stone_map), "lidar_horizontal", stamp_s
        )
        mapper.add_scan_pair([*quick(yard, stamp_s), stone], told(yard.motion(stamp_s), 0.2))
    assert stone_or_ghost() > 50
    ground = mapper.cloud().points
    mapper.remove_sphere(np.array([5.0, 2.0, 0.6]), 1.0)
    assert stone_or_ghost() == 0
    for k in range(12):  # fixes come, and say that all is 10 cm higher
        motion = told(yard.motion(1.5 + 0.1 * k), 0.001)
        higher = replace(motion, T_map_cabin=pose(t=np.array([0.0, 0.0, 0.1])) @ motion.T_map_cabin)
        mapper.add_scan_pair(quick(yard, 1.5 + 0.1 * k), higher)
    moved = mapper.cloud().points
    assert np.median(ground[ground[:, 2] < 0.3, 2]) == pytest.approx(0.0, abs=0.01)
    assert (
        np.quantile(moved[np.abs(moved[:, 2]) < 0.3, 2], 0.25) > 0.05
    )  # the first scans have followed
    assert stone_or_ghost() == 0


def test_a_long_mission_costs_no_more_memory_than_a_short_one(
    make_graph: Callable, make_yard: Callable
) -> None:
    yard, mapper = make_yard(RATE_RAD_S), make_graph(window=20, **COARSE)
    for k in range(70):
        mapper.add_scan_pair(quick(yard, 1 + 0.1 * k, 20), yard.motion(1 + 0.1 * k))
        parts = mapper._parts
        assert len(parts.store) <= 20
        assert len(parts.track.poses().T_map_cabin) <= 40
    assert parts.track.next_number == 70


def test_what_the_machine_has_left_behind_is_not_there_when_it_comes_back(
    make_graph: Callable, make_yard: Callable, machine: Machine
) -> None:
    yard, mapper = make_yard(0.0), make_graph(radius_m=10.0, min_points=1, **COARSE)
    wall = np.stack(np.meshgrid([3.0], np.arange(-1, 1, 0.1), np.arange(1, 2, 0.1)), axis=-1)
    lone = yard.as_scan(np.array([[4.0, 0.0, 0.0]]), "lidar_horizontal")

    def drive_to(x_m: float) -> None:
        motion = yard.motion(1.0)
        there = pose(t=np.array([x_m, 0.0, 0.0])) @ motion.T_map_cabin
        mapper.add_scan_pair([lone], replace(motion, T_map_cabin=there))

    def points_of_the_wall() -> int:
        return int((np.abs(mapper.cloud().points[:, 0] - 3.0) < 0.2).sum())

    drive_to(0.0)
    mapper.add_surface(wall.reshape(-1, 3))
    drive_to(5.0)
    drive_to(0.0)
    assert points_of_the_wall() > 100
    drive_to(30.0)
    drive_to(0.0)
    assert points_of_the_wall() == 0


def test_a_pair_without_returns_changes_nothing(make_graph: Callable, make_yard: Callable) -> None:
    yard, mapper = make_yard(0.0), make_graph(min_points=1, **COARSE)
    empty = yard.as_scan(np.zeros((0, 3)), "lidar_horizontal")
    assert mapper.add_scan_pair([empty], yard.motion(1.0)) == 0
    assert len(mapper.cloud()) == 0
    lone = yard.as_scan(np.array([[4.0, 0.0, 0.0], [5.0, 1.0, 0.0]]), "lidar_horizontal")
    assert mapper.add_scan_pair([lone, empty], yard.motion(1.0)) == 2
    assert len(mapper.cloud()) == 2


def test_a_separate_process_gives_the_same_planes(
    make_graph: Callable, make_yard: Callable, off_planes: Callable
) -> None:
    yard = make_yard(RATE_RAD_S)
    inline, beside = make_graph(**COARSE), make_graph(process=True, answer_within_s=60, **COARSE)
    for k in range(8):
        for mapper in (inline, beside):
            mapper.add_scan_pair(quick(yard, 1 + 0.1 * k), yard.motion(1 + 0.1 * k))
    here, there = inline.cloud().points, beside.cloud().points
    # Answers of the other process come in their own order, which decides what is thinned.
    assert abs(len(here) - len(there)) < 0.25 * len(here)
    assert np.quantile(off_planes(here), 0.95) < 0.03
    assert np.quantile(off_planes(there), 0.95) < 0.03


def test_errors_of_bad_input_name_the_cause(make_graph: Callable, machine: Machine) -> None:
    with pytest.raises(DataError, match="not be negative"):
        make_graph().mask_held(-1.0)
    with pytest.raises(ConfigError, match="not started"):
        PoseGraph(PoseGraphSettings(), machine).cloud()


def test_a_thread_that_fuses_a_pair_and_one_that_reads_the_map_wait_for_each_other(
    make_graph: Callable, make_yard: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    yard, mapper, alone = make_yard(rate_rad_s=0.35), make_graph(), make_graph()
    begun, go_on, cloud = threading.Event(), threading.Event(), MapCloud.cloud
    for one in (mapper, alone):
        one.add_scan_pair(yard.pair(1.0), yard.motion(1.0))
    before = alone.cloud().points

    def slowly(self: MapCloud, *given: Any) -> Cloud:
        begun.set()
        assert go_on.wait(60.0)
        return cloud(self, *given)

    monkeypatch.setattr(MapCloud, "cloud", slowly)
    found: list[Cloud] = []
    reading = threading.Thread(target=lambda: found.append(mapper.cloud()), daemon=True)
    fusing = threading.Thread(
        target=lambda: mapper.add_scan_pair(yard.pair(1.3), yard.motion(1.3)), daemon=True
    )
    reading.start()
    assert begun.wait(60.0)
    fusing.start()
    fusing.join(0.1)
    assert fusing.is_alive()
    go_on.set()
    for thread in (reading, fusing):
        thread.join(60.0)
    alone.add_scan_pair(yard.pair(1.3), yard.motion(1.3))
    np.testing.assert_array_equal(found[0].points, before)
    np.testing.assert_array_equal(mapper.cloud().points, alone.cloud().points)
    assert len(mapper.cloud()) != len(before)
