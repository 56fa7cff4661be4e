"""What every mapper must do, whatever its method."""

from collections.abc import Callable

import numpy as np
import pytest

from executive.errors import DataError
from executive.interfaces.mapping import Mapper
from executive.machine.machine import Machine
from executive.messages.lidar import LidarScan
from executive.messages.sector import Sector
from executive.testing.exercises.mapping import T_MAP_CABIN, filled, lidars, motion, pair

CAPABILITY = "mapping"


def test_a_new_map_is_empty(make: Callable[[], Mapper]) -> None:
    mapper = make()
    assert len(mapper.cloud()) == 0
    assert mapper.cloud().frame == "map"


def test_surfaces_are_mapped_where_they_are(make: Callable[[], Mapper], machine: Machine) -> None:
    mapper = make()
    assert mapper.add_scan_pair(pair(machine, 1.0, 0), motion(machine, 1.0)) > 20_000
    points = filled(mapper, machine).cloud().points
    assert len(points) > 5000
    off = np.minimum(np.abs(points[:, 2]), np.abs(points[:, 0] - 8.0))
    assert off.max() < 0.03


def test_a_removed_sphere_is_empty(make: Callable[[], Mapper], machine: Machine) -> None:
    mapper = filled(make(), machine)
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


def test_a_surface_that_is_put_back_is_shown(make: Callable[[], Mapper], machine: Machine) -> None:
    mapper = filled(make(), machine)
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


def test_a_handed_out_cloud_does_not_change(make: Callable[[], Mapper], machine: Machine) -> None:
    mapper = filled(make(), machine)
    cloud = mapper.cloud()
    copy = cloud.points.copy()
    filled(mapper, machine).remove_sphere(np.array([6.0, 2.0, 0.0]), 2.0)
    np.testing.assert_array_equal(cloud.points, copy)


def test_no_scans_add_nothing(make: Callable[[], Mapper], machine: Machine) -> None:
    mapper = make()
    empty = [LidarScan(1.0, lidar, np.empty((0, 3)), np.empty(0)) for lidar in lidars(machine)]
    assert mapper.add_scan_pair([], motion(machine, 1.0)) == 0
    assert mapper.add_scan_pair(empty, motion(machine, 1.0)) == 0
    assert len(mapper.cloud()) == 0


def test_an_unknown_sensor_is_an_error(make: Callable[[], Mapper], machine: Machine) -> None:
    stranger = LidarScan(1.0, "lidar_of_another_machine", np.full((5, 3), 5.0), np.ones(5))
    with pytest.raises(DataError, match="lidar_of_another_machine"):
        make().add_scan_pair([stranger], motion(machine, 1.0))


def test_the_dense_share_is_that_of_the_cells_it_shows(
    make: Callable[[], Mapper], machine: Machine
) -> None:
    """Beyond a wall at x = 8 m nothing is mapped, and behind the cabin neither."""
    mapper = filled(make(), machine)
    centre = T_MAP_CABIN[:2, 3]
    seen = Sector(centre, 0.0, 0.6, 3.5, 6.5)
    assert mapper.dense_share(seen, 20.0) == 1.0
    assert mapper.dense_share(seen, 1e6) == 0.0
    half = Sector(centre, 0.0, 0.2, 1.0, 13.0)  # 1 m to 13 m, of which 3 m to 7 m is mapped
    assert 0.1 < mapper.dense_share(half, 20.0) < 0.6
    assert mapper.dense_share(Sector(centre, np.pi, 0.6, 3.5, 6.5), 1.0) == 0.0


def test_a_new_map_is_nowhere_dense(make: Callable[[], Mapper]) -> None:
    assert make().dense_share(Sector(np.zeros(2), 0.0, 1.0, 2.0, 6.0), 1.0) == 0.0


def test_a_sector_without_a_cell_is_refused(make: Callable[[], Mapper], machine: Machine) -> None:
    with pytest.raises(DataError, match="larger"):
        filled(make(), machine).dense_share(Sector(np.zeros(2), 0.0, 0.01, 2.0, 2.1), 1.0)
