"""A map that forgets what its rays pass through, and keeps what they do not reach."""

import numpy as np
import pytest
from executive_plugins.mapping import carving
from executive_plugins.mapping.carving import VOXELS, Carver
from executive_plugins.mapping.range_image import nearest_returns, passed_on_both_sides
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.arrays import Float

VOXEL_M = 0.03
STANDING_AFTER = 20  # scan pairs
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
        self.carver = Carver(VOXEL_M, 10.0, 0.3, after, 0.25, STANDING_AFTER)
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


def test_what_left_is_forgotten_within_ten_scans(worlds: dict[int, World]) -> None:
    """The rings of one lidar are 2° apart, 20 cm here: most places are passed by no ray."""
    assert worlds[3].before[id(GONE)] > 300
    assert worlds[3].count(GONE) <= 0.05 * worlds[3].before[id(GONE)]


def test_without_carving_it_stays(worlds: dict[int, World]) -> None:
    assert worlds[1000].count(GONE) == worlds[1000].before[id(GONE)]


def test_what_stands_still_and_what_it_hides_stay(worlds: dict[int, World]) -> None:
    for box in (STAYS, HIDDEN):
        assert worlds[3].before[id(box)] > 30
        assert worlds[3].count(box) == worlds[1000].count(box)


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


def test_what_is_put_back_from_the_database_is_carved_only_once_it_is_seen_through() -> None:
    carver = Carver(VOXEL_M, 10.0, 0.3, 2, 0.25, STANDING_AFTER)
    there = np.array([[3.0, 0.0, 0.0]])
    carver.add(there)
    view = (np.zeros(3), rays([-0.02, 0.02], [6.0, 6.0]))
    assert [len(carver.see([view])) for _ in range(3)] == [0, 1, 0]


def share_moving(world: World, box: Float) -> float:
    """Return the share of a box's points in places of which the map says that they move."""
    points = world.grid.points()[0]
    inside = (points > box[0] - 0.06).all(axis=1) & (points < box[1] + 0.06).all(axis=1)
    return world.carver.moving().share(points[inside & (points[:, 2] > 0.25)])


WALKER = np.array([[5.0, -1.0, 0.0], [5.4, -0.5, 1.7]])


def test_what_walks_moves_and_what_stands_does_not() -> None:
    world, step = World(3), np.array([0.0, 0.1, 0.0])  # 1 m/s at 10 Hz
    world.run([STAYS], 30)
    assert share_moving(world, STAYS) < 0.05
    for k in range(20):
        world.run([STAYS, WALKER + k * step], 1)
    assert share_moving(world, WALKER + 19 * step) > 0.9
    assert share_moving(world, STAYS) < 0.05


def test_what_came_stands_once_it_has_stayed() -> None:
    world = World(3)
    world.run([STAYS], 30)
    world.run([STAYS, WALKER], 1)
    assert share_moving(world, WALKER) > 0.9
    world.run([STAYS, WALKER], STANDING_AFTER - 1)
    assert share_moving(world, WALKER) > 0.5
    world.run([STAYS, WALKER], 1)
    assert share_moving(world, WALKER) < 0.2  # what came into view later is not old enough yet


def test_what_leaves_moves_until_it_is_forgotten() -> None:
    world = World(6)
    world.run([STAYS, WALKER], 40)
    assert share_moving(world, WALKER) < 0.05
    world.run([STAYS], 2)
    assert share_moving(world, WALKER) > 0.5


def test_what_a_shadow_hid_before_did_not_come() -> None:
    """The place behind a block is seen for the first time when the block is taken away."""
    behind = np.array([[3.6, 3.6, 0.0], [4.0, 4.0, 0.5]])
    world = World(3)
    world.run([STAYS, behind], 30)
    assert world.count(behind) == 0
    world.run([behind], 5)
    assert world.count(behind) > 30
    assert share_moving(world, behind) < 0.05


def rays(ups_rad: list[float], ranges_m: list[float]) -> Float:
    """Return returns of level fans of rays about the x axis, each at an elevation [m]."""
    across = np.arange(-0.2, 0.2, 0.005)
    fans = [
        range_m
        * np.column_stack(
            [np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.full(80, np.sin(up))]
        )
        for up, range_m in zip(ups_rad, ranges_m, strict=True)
    ]
    return np.vstack(fans)


@pytest.mark.parametrize(
    ("ups_rad", "ranges_m", "is_passed"),
    [
        ([-0.02, 0.02], [9.0, 9.0], True),
        ([-0.02, 0.02], [5.1, 9.0], False),  # the ray below ends on what stands there
        ([0.02], [9.0], False),  # nothing below: it may be the top of a stone
        ([-0.06, 0.06], [9.0, 9.0], False),  # 60 cm apart: a stone fits between
        ([-0.02, 0.0, 0.02], [9.0, 3.0, 9.0], False),  # hidden
    ],
)
def test_a_place_is_seen_through_if_rays_pass_on_both_sides_of_it(
    ups_rad: list[float], ranges_m: list[float], is_passed: bool
) -> None:
    nearest = nearest_returns(np.zeros(3), rays(ups_rad, ranges_m))
    place = np.array([5.0, 0.0, 0.0])
    assert passed_on_both_sides(nearest, np.zeros(3), place, 0.25, 0.3) == is_passed


FEW = 20  # gaps that are left alone, here


def flickering(few: int, monkeypatch: pytest.MonkeyPatch) -> tuple[list[Float], int]:
    """Show and hide stones again and again, where each is forgotten after two pairs; return what
    was forgotten, and how many rows the table has at the end.
    """
    monkeypatch.setattr(carving, "_FEW", few)
    carver, rng = Carver(VOXEL_M, 10.0, 0.3, 2, 0.25, STANDING_AFTER), np.random.default_rng(3)
    forgotten = []
    for k in range(200):
        box = GONE + np.array([0.0, 0.6 * (k % 5) - 1.2, 0.0])
        forgotten.append(carver.see([scan([box], 0.0, rng)]))
        forgotten += [carver.see([scan([], 0.0, rng)]) for _ in range(2)]
    return forgotten, carver._used


def test_what_comes_and_goes_takes_no_memory_in_the_long_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    grown, rows = flickering(10**9, monkeypatch)
    closed, closed_rows = flickering(FEW, monkeypatch)
    known = rows - sum(map(len, grown))
    assert rows > 4 * known  # so a table whose gaps stay grows
    assert closed_rows <= 2 * known + FEW
    for one, other in zip(grown, closed, strict=True):
        np.testing.assert_array_equal(one, other)


def test_places_far_from_all_returns_are_told_without_a_look_at_them() -> None:
    """The blocks of directions leave out no place that a look at the rays themselves would find."""
    rng = np.random.default_rng(26127121)
    points = rng.normal(0, 1, (400, 3)) * [1, 1, 0.15] + rng.choice([-6.0, 6.0], (400, 3))
    image = nearest_returns(np.zeros(3), points)
    everywhere = image._replace(is_about=np.ones_like(image.is_about))
    places = rng.uniform(-6, 6, (20_000, 3))
    found, wanted = (
        [passed_on_both_sides(one, np.zeros(3), place, 0.25, 0.3) for place in places]
        for one in (image, everywhere)
    )
    assert found == wanted
    assert 20 < sum(wanted) < len(places)
    assert image.is_about.mean() < 0.5
