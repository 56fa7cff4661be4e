"""The parts of maps on coarse grids, where distances and counts meet limits exactly."""

import numpy as np
import pytest
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.density import dense_share
from executive_plugins.mapping.deskew import cabin_poses, place, time_slices
from executive_plugins.mapping.graph_host import InlineGraph
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.node_track import NodeTrack
from executive_plugins.mapping.odometry_noise import OdometryNoise
from executive_plugins.mapping.pair_graph import PairGraph, PairNode, Poses
from executive_plugins.mapping.pair_store import PairStore
from executive_plugins.mapping.pose_constraint import PoseConstraint
from executive_plugins.mapping.scan_matching import ScanMatcher
from executive_plugins.mapping.settings import (
    OdometryNoiseSettings,
    ScanMatchingSettings,
    VoxelMapSettings,
)
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.errors import DataError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.sector import Sector

# Where an iteration ends is decided by a tolerance of its own.
ITERATED = 1e-6


def turned(k: float) -> np.ndarray:
    return pose(exp_so3(np.array([0.01, -0.02, 0.1]) * k), np.array([0.3, 0.1, -0.05]) * k)


def cloud(seed: int, count: int = 300, spread: int = 16) -> np.ndarray:
    return np.random.default_rng(seed).integers(-spread, spread, (count, 3)) / 8.0


def test_cylinder(recorded) -> None:
    cylinder, told = Cylinder(2.0), []
    for x in (0.0, 0.5, 0.625, 1.0, 1.125, 1.25):
        told.append((cylinder.follow(np.array([x, 0.0, 0.0])), cylinder.contains(cloud(1) * 1.5)))
    recorded(told)


@pytest.mark.parametrize("least", [1.0, 2.0, 3.0])
def test_density(recorded, least) -> None:
    points = np.random.default_rng(2).integers(-12, 12, (260, 3)) / 2.0
    told = []
    for heading, angle, nearest, farthest in (
        (0.0, 1.0, 1.0, 4.0),
        (3.0, 2.0, 0.0, 3.5),
        (-2.5, 6.5, 0.5**0.5, 2.0),
        (0.0, np.pi / 2, 0.5, 5.0),
        (0.7, 1.5, 2.5**0.5, 4.5),
    ):
        sector = Sector(np.array([0.5, -0.25]), heading, angle, nearest, farthest)
        told.append(dense_share(points, sector, least))
    with pytest.raises(DataError) as refused:
        dense_share(points, Sector(np.zeros(2), 0.0, 0.01, 2.0, 2.1), 1.0)
    recorded((told, refused.value))


def test_time_slices(recorded) -> None:
    told = []
    for stamps in ([1.0], [1.0, 1.0], [1.0, 1.25, 1.5, 1.75, 2.0], [1.0, 1.1, 1.35, 1.6]):
        scan = LidarScan(2.0, "a", np.ones((len(stamps), 3)), np.array(stamps))
        told += [time_slices(scan, slice_s) for slice_s in (0.25, 0.3, 5.0)]
    recorded(told)


def test_placing(recorded) -> None:
    rng = np.random.default_rng(3)
    poses = np.array([turned(k) for k in range(4)])
    slices, fractions = rng.integers(0, 3, 12), rng.integers(0, 5, 12) / 4.0
    moved = Motion(np.arange(4.0), poses, ("a",), np.zeros((4, 1)))
    told = place(cloud(4, 12), slices, fractions, poses), cabin_poses(moved, np.array([-1, 0.5, 9]))
    recorded(told)


def test_track(recorded) -> None:
    track, told = NodeTrack(4), []
    for k in range(7):
        track.append(turned(0.5), turned(0.5 * k))
        if k in (1, 3, 6):
            first = max(0, k - 4)
            track.take(Poses(first, np.array([turned(0.6 * i) for i in range(first, k)])))
        told.append((track.next_number, track.poses(), track.pose_of(k)))
    track.take(Poses(0, np.array([np.eye(4)])))
    track.take(Poses(6, np.array([turned(9)])))
    told.append(track.poses())
    recorded(told)


def test_odometry_noise(recorded) -> None:
    noise = OdometryNoise(OdometryNoiseSettings(anchor_period_s=0.5))
    small, large = np.diag(np.arange(1.0, 7)) * 1e-6, np.eye(6) * 1e-4
    told = [
        noise.increment(turned(1), duration_s, now, before)
        for duration_s in (0.0, 0.1, 10.0)
        for now, before in ((None, None), (small, large), (large, None))
    ]
    told += [noise.anchor(turned(1), s, P) for s in (0.0, 0.5, 8.0) for P in (None, small)]
    recorded((told, [noise.is_due(s) for s in (0.25, 0.5, 0.75)]))


def test_constraints_are_checked(recorded) -> None:
    told = []
    for P in (np.zeros((6, 6)), -np.eye(6), np.eye(6) - np.ones((6, 6))):
        with pytest.raises(DataError) as refused:
            PoseConstraint(np.eye(4), P)
        told.append(refused.value)
    recorded((told, PoseConstraint(np.eye(4), np.eye(6) + np.triu(np.ones((6, 6)), 1))))


def node(k: int, wrong: float = 0.0, **others: object) -> PairNode:
    P, tight = np.diag([1e-4] * 3 + [4e-4] * 3), 1e-6 * np.eye(6)
    between = inverse(turned(k - 1)) @ turned(k)
    given = {
        "estimate": PoseConstraint(turned(k + 0.02 * np.sin(k)), P),
        "is_anchor": k % 3 == 0,
        "odometry": PoseConstraint(between @ turned(0.01), tight) if k else None,
        "match": PoseConstraint(between @ turned(wrong), tight) if k % 2 else None,
    } | others
    return PairNode(k, turned(k + 0.1), **given)


@pytest.mark.parametrize("window", [4, 7])
def test_graph(recorded, window) -> None:
    graph, told = PairGraph(window), []
    for k in range(14):
        told.append((graph.add(node(k, 0.4 if k == 5 else 0.0)), len(graph), graph.restarts))
    told.append((graph.add(node(20)), len(graph), graph.restarts))
    told.append((graph.add(node(21, odometry=None, match=None)), len(graph), graph.restarts))
    told.append((graph.add(node(22, odometry=None)), len(graph), graph.restarts))
    told.append((graph.add(node(23, match=None)), len(graph), graph.restarts))
    recorded(told, relative=ITERATED)


def test_inline_host(recorded) -> None:
    host = InlineGraph(4)
    told = [host.take()]
    for k in range(2):
        host.add(node(k))
    recorded((told, host.take(), host.take()), relative=ITERATED)


def test_store(recorded) -> None:
    store, told = PairStore(0.5, 3, 3, 4.0), []
    for k in range(5):
        store.add(k // 2, cloud(k, 60).astype(np.float32), turned(0.1), turned(k // 2))
        told.append((len(store), store.is_stale, store.grid().points()))
    for shift in (0.1, 0.3):
        moved = np.array([turned(1 + shift), turned(2 + shift)])
        store.move(Poses(1, moved))
        told.append((store.is_stale, store.grid().points(), store.is_stale))
    store.add_surface(cloud(9, 30) + [2, 0, 0])
    told.append(store.forget_sphere(np.array([0.5, 0, 0]), 1.0, 2))
    told.append(store.grid().points())
    store.move(Poses(2, np.array([turned(4)])))
    told.append((store.is_stale, store.grid().points()))
    store.keep(lambda points: points[:, 0] > 1.2)
    told.append((len(store), store.grid().points()))
    store.move(Poses(2, np.array([turned(6)])))
    told.append((len(store), store.grid().points()))
    recorded(told)


def test_store_is_stale_beyond_half_a_voxel(recorded) -> None:
    told = []
    for shift_m, turn_rad in (
        (0.25, 0.0),
        (0.2500001, 0.0),
        (0.0, 0.0624),
        (0.0, 0.0626),
        (0.1, 0.04),
    ):
        store = PairStore(0.5, 3, 3, 4.0)
        store.add(0, cloud(1, 20).astype(np.float32), np.eye(4), np.eye(4))
        T = pose(exp_so3(np.array([0, 0, turn_rad])), np.array([shift_m, 0, 0]))
        store.move(Poses(0, T[None]))
        told.append(store.is_stale)
    recorded(told)


def surface(grid: VoxelGrid, voxel_m: float, reach_m: float) -> np.ndarray:
    settings = VoxelMapSettings(voxel_m=voxel_m, smoothing_m=reach_m, memory=4)
    return MapCloud(settings).cloud(grid, Cylinder(10.0)).points


def test_grid(recorded) -> None:
    told = []
    for voxel_m, memory in ((0.5, 1), (0.25, 4), (1.0, 100)):
        grid = VoxelGrid(voxel_m, memory)
        grid.insert(cloud(5))
        grid.insert(cloud(6))
        told += [len(grid), grid.points()]
        told += [surface(grid, voxel_m, reach * voxel_m) for reach in (0.75, 1.0)]
        twin = grid.copy()
        told.append(twin.forget_sphere(np.zeros(3), 0.5, 2))
        twin.keep(twin.points()[1] > 1)
        told += [len(twin), twin.points(), len(grid)]
    recorded(told)


def test_grid_grows(recorded) -> None:
    grid = VoxelGrid(0.125, 2)
    for k in range(3):
        grid.insert(np.random.default_rng(k).integers(-300, 300, (90_000, 3)) / 8.0)
    recorded((len(grid), grid.points()))


def test_grid_ends(recorded) -> None:
    grid, told = VoxelGrid(1.0, 2), []
    far = float((1 << 20) - 1)
    grid.insert(np.array([[far - 1.5, 0.0, -(far - 1.5)]]))
    for x in (far, -far, far + 1):
        with pytest.raises(DataError) as refused:
            grid.insert(np.array([[0.0, x, 0.0]]))
        told.append(refused.value)
    recorded((grid.points(), told))


def scan(T_map_cabin, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-4, 4, (2, 700))
    walls = np.vstack([np.c_[u, v, 0 * u], np.c_[u, 0 * u + 4, v + 3], np.c_[0 * u - 4, u, v + 3]])
    return transform(inverse(T_map_cabin), walls).astype(np.float32)


def test_matching(recorded) -> None:
    told = []
    for changed in ({}, {"max_shift_m": 0.02}, {"max_turn_rad": 0.002}, {"least_inliers": 1.0},
                    {"pairs": 1, "max_distance_m": 0.5}):  # fmt: skip
        matcher = ScanMatcher(ScanMatchingSettings(**changed))
        told.append(matcher.match(scan(np.eye(4), 0), np.eye(4), lambda k: turned(0.1 * k)))
        for k in range(3):
            matcher.add(k, scan(turned(0.1 * k), k))
        matcher.add(3, np.empty((0, 3), np.float32))
        here = scan(turned(0.3), 7)
        told.append(matcher.match(here, turned(0.4), lambda k: turned(0.1 * k)))
        told.append(matcher.match(here[:0], turned(0.4), lambda k: turned(0.1 * k)))
        matcher.forget()
        told.append(matcher.match(here, turned(0.4), lambda k: turned(0.1 * k)))
    recorded(told, relative=ITERATED)
