"""A map that forgets what its rays pass through, and keeps what they do not reach."""

import numpy as np
import pytest
from executive_plugins.mapping.carving import VOXELS, Carver
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.arrays import Float

VOXEL_M = 0.03
GONE = np.array([[5.5, -0.5, 0.0], [6.5, 0.5, 0.9]])  # lowest and highest corner of a block [m]
STAYS = np.array([[2.4, 2.4, 0.0], [3.4, 3.4, 1.2]])
HIDDEN = np.array([[4.2, 4.2, 0.0], [4.9, 4.9, 0.4]])  # behind the one that stays


def scan(boxes: list[Float], swing_rad: float, rng: np.random.Generator) -> tuple[Float, Float]:
    """Return the position of a lidar of 16 rings on a swinging mast, and its returns [m]."""
    origin = np.array([1.3 * np.cos(swing_rad), 1.3 * np.sin(swing_rad), 2.9])
    azimuth, ring = np.meshgrid(np.arange(-1.0, 1.0, 0.005), np.radians(np.arange(-38, -7, 2)))
    azimuth = azimuth.ravel() + swing_rad
    rays = np.column_stack(
        [
            np.cos(ring.ravel()) * np.cos(azimuth),
            np.cos(ring.ravel()) * np.sin(azimuth),
            np.sin(ring.ravel()),
        ]
    )
    ranges = -origin[2] / rays[:, 2]
    for low, high in boxes:
        at = np.sort(np.stack([(low - origin) / rays, (high - origin) / rays]), axis=0)
        first, last = at[0].max(axis=1), at[1].min(axis=1)
        is_hit = (first < last) & (first > 0)
        ranges = np.where(is_hit, np.minimum(ranges, first), ranges)
    kept = ranges < 12
    noisy = ranges[kept] + rng.normal(0, 0.02, kept.sum())
    return origin, origin + rays[kept] * noisy[:, None]


def within(points: Float, box: Float, least_height_m: float) -> int:
    """Return how many points are on a box, above a height [m]."""
    margin = 0.06
    inside = (points > box[0] - margin).all(axis=1) & (points < box[1] + margin).all(axis=1)
    return int((inside & (points[:, 2] > least_height_m)).sum())


class World:
    """A map that is fed by one swinging lidar."""

    def __init__(self, after: int) -> None:
        self.grid = VoxelGrid(VOXEL_M, 100)
        self.carver = Carver(VOXEL_M, 10.0, 0.3, after)
        self.rng, self.swing_rad = np.random.default_rng(5), 0.0
        self.before: dict[int, int] = {}

    def run(self, boxes: list[Float], pairs: int) -> None:
        for _ in range(pairs):
            self.swing_rad += 0.0175  # 10°/s at 10 Hz
            view = scan(boxes, 0.6 * np.sin(self.swing_rad), self.rng)
            self.grid.insert(view[1])
            self.grid.erase(self.carver.see([view]), VOXELS)

    def count(self, box: Float, least_height_m: float = 0.25) -> int:
        return within(self.grid.points()[0], box, least_height_m)


@pytest.fixture(scope="module")
def worlds() -> dict[int, World]:
    """Return maps of a site of which one block was taken away, by the pairs after which they
    forget.
    """
    made = {}
    for after in (3, 1000):
        world = made[after] = World(after)
        world.run([GONE, HIDDEN], 25)
        world.run([GONE, STAYS, HIDDEN], 25)
        world.before = {id(box): world.count(box) for box in (GONE, STAYS, HIDDEN)}
        world.run([STAYS, HIDDEN], 10)
    return made


def test_most_of_what_left_is_forgotten_within_ten_scans(worlds: dict[int, World]) -> None:
    """What no ray passes stays until one does: the rings of one lidar are 2° apart, 20 cm here."""
    assert worlds[3].before[id(GONE)] > 300
    assert worlds[3].count(GONE) <= 0.4 * worlds[3].before[id(GONE)]


def test_without_carving_it_stays(worlds: dict[int, World]) -> None:
    assert worlds[1000].count(GONE) == worlds[1000].before[id(GONE)]


def test_what_stands_still_and_what_it_hides_stay(worlds: dict[int, World]) -> None:
    for box in (STAYS, HIDDEN):
        assert worlds[3].before[id(box)] > 30
        assert worlds[3].count(box) >= 0.97 * worlds[1000].count(box)


def test_the_ground_stays(worlds: dict[int, World]) -> None:
    ground = [
        {tuple(x) for x in np.floor(p[(p[:, 2] < 0.1)][:, :2] / 0.12).astype(int)}
        for p in (worlds[after].grid.points()[0] for after in (3, 1000))
    ]
    assert len(ground[0] & ground[1]) > 0.99 * len(ground[1])


def test_an_erased_voxel_begins_anew() -> None:
    grid = VoxelGrid(1.0, 100)
    grid.insert(np.full((5, 3), 0.2))
    assert grid.erase(np.zeros((1, 3), dtype=np.int64), 1) == 1
    assert len(grid) == 0
    grid.insert(np.full((1, 3), 0.8))
    means, counts = grid.points()
    np.testing.assert_allclose(means, [[0.8, 0.8, 0.8]])
    assert counts.tolist() == [1]


def test_columns_are_counted_once() -> None:
    grid = VoxelGrid(1.0, 100)
    grid.insert(np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 3.5], [-2.5, 7.5, 0.5], [5.5, 5.5, 0.5]] * 2))
    grid.insert(np.array([[9.5, 0.5, 0.5]]))
    grid.erase(np.array([[5, 5, 0]]), 1)
    assert sorted(map(tuple, grid.columns(2))) == [(-2.5, 7.5), (0.5, 0.5)]
    assert len(VoxelGrid(1.0, 100).columns(1)) == 0


def test_what_is_put_back_from_the_database_is_carved_only_once_it_is_seen_through() -> None:
    carver = Carver(VOXEL_M, 10.0, 0.3, 2)
    there = np.array([[3.0, 0.0, 0.0]])
    carver.add(there)
    ray = (np.zeros(3), np.array([[6.0, 0.0, 0.0]] * 3))
    assert [len(carver.see([ray])) for _ in range(3)] == [0, 1, 0]
