"""Heaps of shapes whose number is known."""

import numpy as np
import pytest
from executive_plugins.segmentation.cluster_splitting import ClusterSplitter
from executive_plugins.segmentation.watershed import basins

PARTING = ClusterSplitter(0.04, 0.05, 0.3, 60, 0.25, 0.16, 0.85)


def thinned(points: np.ndarray, voxel_m: float = 0.03) -> np.ndarray:
    """One point a voxel, as in a map."""
    _, first = np.unique(np.floor(points / voxel_m).astype(int), axis=0, return_index=True)
    return points[np.sort(first)]


def sphere(x: float, radius_m: float, count: int = 40_000) -> np.ndarray:
    directions = np.random.default_rng(0).normal(size=(count, 3))
    points = radius_m * directions / np.linalg.norm(directions, axis=1)[:, None] + [
        x,
        0.0,
        0.7 * radius_m,
    ]
    return points[points[:, 2] > 0.1]


def cylinder(radius_m: float, length_m: float) -> np.ndarray:
    """A lying one, its axis along x."""
    rng = np.random.default_rng(0)
    angle = rng.uniform(-np.pi, np.pi, 40_000)
    along = rng.uniform(-length_m / 2, length_m / 2, len(angle))
    points = np.column_stack([along, radius_m * np.cos(angle), radius_m * (1 + np.sin(angle))])
    return points[points[:, 2] > 0.1]


def slab(x: float, size_m: tuple[float, float, float]) -> np.ndarray:
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.5, 0.5, (60_000, 3))
    face = rng.integers(3, size=len(points))
    points[np.arange(len(points)), face] = np.sign(points[np.arange(len(points)), face]) / 2
    points = points * size_m + [x, 0.0, size_m[2] / 2]
    return points[points[:, 2] > 0.1]


def stones_in(*shapes: np.ndarray, voxel_m: float = 0.03) -> list[np.ndarray]:
    points = thinned(np.vstack(shapes) + np.random.default_rng(1).normal(0, 0.006, (1, 3)), voxel_m)
    return [points[rows] for rows in PARTING.split(points, points[:, :2], points[:, 2])]


@pytest.mark.parametrize(
    "shape",
    [sphere(0, 0.5), cylinder(0.3, 1.6), slab(0, (1.2, 0.8, 0.4))],
    ids=["sphere", "cylinder", "slab"],
)
def test_one_shape_is_one_stone(shape: np.ndarray) -> None:
    assert len(stones_in(shape)) == 1


def test_touching_spheres_are_parted_at_the_plane_between_them() -> None:
    parts = sorted(
        stones_in(sphere(-0.5, 0.5), sphere(0.5, 0.5)), key=lambda part: part[:, 0].mean()
    )
    assert len(parts) == 2
    assert parts[0][:, 0].max() < 0.06  # a cell of the view from above
    assert parts[1][:, 0].min() > -0.06


def test_unequal_touching_spheres_are_parted() -> None:
    assert len(stones_in(sphere(-0.5, 0.5), sphere(0.45, 0.45))) == 2


def test_slabs_with_a_slit_between_upright_sides_are_parted() -> None:
    parts = stones_in(slab(-0.55, (1.0, 0.8, 0.5)), slab(0.55, (1.0, 0.8, 0.5)))
    assert sorted(np.sign(part[:, 0].mean()) for part in parts) == [-1, 1]


def test_a_thinly_seen_stone_stays_whole() -> None:
    """Its points lie so far apart that the finer grid takes it to pieces."""
    shape = sphere(0, 0.5)
    for seed in range(8):
        points = thinned(shape[np.random.default_rng(seed).choice(len(shape), 260, replace=False)])
        assert len(PARTING.split(points, points[:, :2], points[:, 2])) == 1


def test_no_point_is_lost_or_given_twice() -> None:
    points = thinned(np.vstack([sphere(-0.52, 0.5), sphere(0.52, 0.5)]))
    rows = np.concatenate(PARTING.split(points, points[:, :2], points[:, 2]))
    np.testing.assert_array_equal(np.sort(rows), np.arange(len(points)))


@pytest.mark.parametrize(("pass_m", "count"), [(0.2, 2), (0.45, 2), (0.75, 1)])
def test_a_pass_parts_two_summits_if_it_is_deep(pass_m: float, count: int) -> None:
    x = np.linspace(-1, 1, 201)
    ridge = 1.0 - (1.0 - pass_m) * np.cos(np.pi * x / 2) ** 8
    places = np.column_stack([np.repeat(x, 41), np.tile(np.linspace(-0.2, 0.2, 41), len(x))])
    found = basins(places, np.repeat(ridge, 41) - 0.1 * np.abs(places[:, 1]), 0.05, 0.4, 6)
    assert len(np.unique(found)) == count
    if count == 2:
        assert (found[places[:, 0] < -0.06] != found[places[:, 0] > 0.06][0]).all()


def test_points_in_close_pairs_are_not_dense() -> None:
    """Two returns of one spot say nothing about the gaps between spots, here of 10 cm."""
    spots = np.mgrid[0:8, 0:8, 0:1].reshape(3, -1).T * 0.10
    pairs = np.vstack([spots, spots + [0.01, 0, 0]])
    splitter = ClusterSplitter(0.04, 0.05, 0.3, 60, 0.25, 0.16, 0.85)
    assert not splitter._is_dense(pairs)
    assert splitter._is_dense(spots * 0.3)


@pytest.mark.parametrize(("side", "expected"), [(2, 1), (3, 2)])
def test_a_summit_of_its_own_has_a_quarter_of_the_least_stone(side: int, expected: int) -> None:
    # A square of the least extent, five cells wide: a quarter of it is six cells. Beside a broad
    # top stands a smaller one, with a deep valley between them.
    cell_m = PARTING.cell_m
    block = [(x, y, 0.5) for x in range(8) for y in range(8)]
    valley = [(8, y, 0.1) for y in range(8)]
    other = [(x, y, 0.4) for x in range(9, 9 + side) for y in range(side)]
    rows = np.array([*block, *valley, *other], dtype=float)
    places = np.vstack([np.zeros(2), (rows[:, :2] + 0.5) * cell_m])  # cells begin at the first
    assert PARTING.count_tops(places, np.r_[0.5, rows[:, 2]]) == expected


@pytest.mark.parametrize(("places", "count"), [([0.0], 1), ([0.0, 1.0], 2)])
def test_as_many_tops_are_counted_as_there_are_parts(places: list[float], count: int) -> None:
    points = thinned(np.vstack([sphere(x, 0.5) for x in places]), 0.03)
    assert PARTING.count_tops(points[:, :2], points[:, 2]) == count
