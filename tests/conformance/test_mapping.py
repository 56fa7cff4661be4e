"""What every mapper must do, whatever its method."""

from collections.abc import Callable

import numpy as np
import pytest

from executive import registry
from executive.errors import DataError
from executive.geometry.pose import inverse, pose, transform
from executive.interfaces.mapping import Mapper
from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.sector import Sector

MACHINE = load_machine("m545")
LIDARS = ("lidar_vertical", "lidar_horizontal")
JOINTS = np.append(MACHINE.posture("scan"), 0.0)
T_MAP_CABIN = pose(None, np.array([1.0, 2.0, 1.4]))


@pytest.fixture(params=[plugin.name for plugin in registry.installed("mapping")])
def make_mapper(request: pytest.FixtureRequest) -> Callable[[], Mapper]:
    plugin = registry.load("mapping", request.param)

    def make() -> Mapper:
        services = {"machine": MACHINE, "rng": np.random.default_rng(0)}
        mapper: Mapper = plugin(
            plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin))
        )
        mapper.start()
        request.addfinalizer(mapper.close)
        return mapper

    return make


def surface(seed: int) -> np.ndarray:
    """Ground in front of the machine, and a wall."""
    rng = np.random.default_rng(seed)
    ground = np.column_stack([rng.uniform(4, 8, 9000), rng.uniform(-2, 6, 9000), np.zeros(9000)])
    wall = np.column_stack([np.full(4000, 8.0), rng.uniform(-2, 6, 4000), rng.uniform(0, 2, 4000)])
    return np.vstack([ground, wall])


def pair(stamp_s: float, seed: int) -> list[LidarScan]:
    frames = Kinematics(MACHINE).frames(JOINTS[:-1])
    T_cabin_base = inverse(frames[MACHINE.cabin_link])
    scans = []
    for k, lidar in enumerate(LIDARS):
        points = transform(
            inverse(T_MAP_CABIN @ T_cabin_base @ frames[lidar]), surface(2 * seed + k)
        )
        scans.append(
            LidarScan(stamp_s, lidar, points, np.linspace(stamp_s - 0.1, stamp_s, len(points)))
        )
    return scans


def motion(stamp_s: float) -> Motion:
    stamps = np.linspace(stamp_s - 0.15, stamp_s, 4)
    return Motion(
        stamps,
        np.repeat(T_MAP_CABIN[None], 4, 0),
        MACHINE.joint_names,
        np.repeat(JOINTS[None], 4, 0),
    )


def filled(mapper: Mapper) -> Mapper:
    for k in range(4):
        mapper.add_scan_pair(pair(1 + 0.1 * k, k), motion(1 + 0.1 * k))
    return mapper


def test_a_new_map_is_empty(make_mapper: Callable[[], Mapper]) -> None:
    mapper = make_mapper()
    assert isinstance(mapper, Mapper)
    assert len(mapper.cloud()) == 0
    assert mapper.cloud().frame == "map"


def test_surfaces_are_mapped_where_they_are(make_mapper: Callable[[], Mapper]) -> None:
    mapper = make_mapper()
    assert mapper.add_scan_pair(pair(1.0, 0), motion(1.0)) > 20_000
    points = filled(mapper).cloud().points
    assert len(points) > 5000
    off = np.minimum(np.abs(points[:, 2]), np.abs(points[:, 0] - 8.0))
    assert off.max() < 0.03


def test_the_same_scans_give_the_same_cloud_and_stay_as_they_were(
    make_mapper: Callable[[], Mapper],
) -> None:
    scans, before = pair(1.0, 0), pair(1.0, 0)
    first, second = make_mapper(), make_mapper()
    for mapper in (first, second):
        mapper.add_scan_pair(scans, motion(1.0))
    np.testing.assert_array_equal(first.cloud().points, second.cloud().points)
    for scan, same in zip(scans, before, strict=True):
        np.testing.assert_array_equal(scan.points_lidar, same.points_lidar)


def test_a_removed_sphere_is_empty(make_mapper: Callable[[], Mapper]) -> None:
    mapper = filled(make_mapper())
    before = len(mapper.cloud())
    centre = np.array([6.0, 2.0, 0.0])
    removed = mapper.remove_sphere(centre, 1.0)
    points = mapper.cloud().points
    assert removed > 100
    assert removed == pytest.approx(
        before - len(points), rel=0.3
    )  # a mapper may count what it keeps, not what it shows
    assert (
        np.linalg.norm(points - centre, axis=1).min() > 0.97
    )  # and may round its surfaces by a voxel


def test_a_surface_that_is_put_back_is_shown(make_mapper: Callable[[], Mapper]) -> None:
    mapper = filled(make_mapper())
    centre = np.array([6.0, 2.0, 0.0])
    before = mapper.cloud().points
    cut = before[np.linalg.norm(before - centre, axis=1) < 0.8]
    mapper.remove_sphere(centre, 1.0)
    mapper.add_surface(cut)
    back = mapper.cloud().points
    back = back[np.linalg.norm(back - centre, axis=1) < 0.9]
    assert 0.6 * len(cut) < len(back) <= len(cut)  # a mapper may round, and thin once more
    assert np.abs(back[:, 2]).max() < 0.03
    with pytest.raises(DataError, match="points_map"):
        mapper.add_surface(np.zeros((5, 2)))


def test_a_handed_out_cloud_does_not_change(make_mapper: Callable[[], Mapper]) -> None:
    mapper = filled(make_mapper())
    cloud = mapper.cloud()
    copy = cloud.points.copy()
    filled(mapper).remove_sphere(np.array([6.0, 2.0, 0.0]), 2.0)
    np.testing.assert_array_equal(cloud.points, copy)


def test_no_scans_add_nothing(make_mapper: Callable[[], Mapper]) -> None:
    mapper = make_mapper()
    empty = [LidarScan(1.0, lidar, np.empty((0, 3)), np.empty(0)) for lidar in LIDARS]
    assert mapper.add_scan_pair([], motion(1.0)) == 0
    assert mapper.add_scan_pair(empty, motion(1.0)) == 0
    assert len(mapper.cloud()) == 0


def test_an_unknown_sensor_is_an_error(make_mapper: Callable[[], Mapper]) -> None:
    stranger = LidarScan(1.0, "lidar_of_another_machine", np.full((5, 3), 5.0), np.ones(5))
    with pytest.raises(DataError, match="lidar_of_another_machine"):
        make_mapper().add_scan_pair([stranger], motion(1.0))


def test_the_dense_share_is_that_of_the_cells_it_shows(make_mapper: Callable[[], Mapper]) -> None:
    """Beyond a wall at x = 8 m nothing is mapped, and behind the cabin neither."""
    mapper = filled(make_mapper())
    centre = T_MAP_CABIN[:2, 3]
    seen = Sector(centre, 0.0, 0.6, 3.5, 6.5)
    assert mapper.dense_share(seen, 20.0) == 1.0
    assert mapper.dense_share(seen, 1e6) == 0.0
    half = Sector(centre, 0.0, 0.2, 1.0, 13.0)  # 1 m to 13 m, of which 3 m to 7 m is mapped
    assert 0.1 < mapper.dense_share(half, 20.0) < 0.6
    assert mapper.dense_share(Sector(centre, np.pi, 0.6, 3.5, 6.5), 1.0) == 0.0


def test_a_new_map_is_nowhere_dense(make_mapper: Callable[[], Mapper]) -> None:
    assert make_mapper().dense_share(Sector(np.zeros(2), 0.0, 1.0, 2.0, 6.0), 1.0) == 0.0


def test_a_sector_without_a_cell_is_refused(make_mapper: Callable[[], Mapper]) -> None:
    with pytest.raises(DataError, match="larger"):
        filled(make_mapper()).dense_share(Sector(np.zeros(2), 0.0, 0.01, 2.0, 2.1), 1.0)
