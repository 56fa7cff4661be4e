"""The ground's slow undulation."""

import numpy as np
import pytest
from executive_plugins.segmentation import grid_solver, ground_surface
from executive_plugins.segmentation.grid_solver import GridSolver
from executive_plugins.segmentation.ground_surface import SurfaceFit, _stiff

from executive.errors import DataError

FIT = SurfaceFit(node_m=0.5, margin_m=0.1, max_rise=0.36, stiffness=0.5)
LEVEL = np.array([0.0, 0.0, 1.0, 0.0])


def waves(xy: np.ndarray) -> np.ndarray:
    return 0.12 * np.sin(xy[:, 0] * 0.9) * np.cos(xy[:, 1] * 0.7)


def ground(rng: np.random.Generator, count: int = 20000) -> np.ndarray:
    xy = rng.uniform(-10, 10, (count, 2))
    return np.column_stack([xy, waves(xy) + rng.normal(0, 0.01, count)])


def test_waves_of_seven_metres_are_followed_to_a_few_centimetres() -> None:
    points = ground(np.random.default_rng(0))
    terrain = FIT.on(FIT.level(points, LEVEL))
    inner = np.abs(points[:, :2]).max(axis=1) < 9
    assert np.abs(points[:, 2]).max() > 0.12  # a plane alone would leave this
    assert np.sqrt(np.mean(terrain.heights_above(points)[inner] ** 2)) < 0.02
    assert np.abs(terrain.heights_above(points)[inner]).max() < 0.09  # below the margin of 10 cm


def test_a_stone_is_not_climbed() -> None:
    rng = np.random.default_rng(0)
    points = ground(rng)
    on_stone = np.linalg.norm(points[:, :2] - [2, 3], axis=1) < 0.8
    top = rng.uniform(-0.56, 0.56, (600, 2)) + np.array([2, 3])
    stone = np.column_stack(
        [top, waves(top) + 0.25]
    )  # flat, and low enough to be taken for ground at first
    terrain = FIT.on(FIT.level(np.vstack([points[~on_stone], stone]), LEVEL))
    np.testing.assert_allclose(terrain.heights_above(stone), 0.25, atol=0.06)


def high_waves(xy: np.ndarray) -> np.ndarray:
    """Crests 0.3 m above the mean, 6 m apart: slopes up to 17 degrees."""
    return np.asarray(0.3 * np.sin(xy[:, 0] * 2 * np.pi / 6))


def test_crests_higher_than_the_margin_are_ground_and_a_stone_on_one_is_not() -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-10, 10, (40_000, 2))
    top = np.array([1.5, 2.0]) + rng.uniform(-0.4, 0.4, (900, 2))
    stone = np.column_stack([top, high_waves(top) + 0.5])
    free = xy[np.abs(xy - [1.5, 2.0]).max(axis=1) > 0.4]
    points = np.column_stack([free, high_waves(free) + rng.normal(0, 0.01, len(free))])
    terrain = FIT.on(FIT.level(np.vstack([points, stone]), LEVEL))
    inner = np.abs(free).max(axis=1) < 9
    assert np.abs(terrain.heights_above(points)[inner]).max() < 0.1
    assert terrain.heights_above(stone).min() > 0.4


def test_a_bank_steeper_than_ground_rises_from_it() -> None:
    steep = SurfaceFit(node_m=0.5, margin_m=0.1, max_rise=np.tan(0.1), stiffness=0.5)
    xy = np.random.default_rng(0).uniform(-10, 10, (40_000, 2))
    points = np.column_stack([xy, high_waves(xy)])
    assert steep.on(steep.level(points, LEVEL)).heights_above(points).max() > 0.3


def test_points_under_the_ground_do_not_lower_it() -> None:
    rng = np.random.default_rng(0)
    points = ground(rng)
    under = rng.uniform([-9, -9, -3.0], [9, 9, -0.5], (400, 3))
    terrain = FIT.on(FIT.level(np.vstack([points, under]), LEVEL))
    inner = np.abs(points[:, :2]).max(axis=1) < 9
    assert np.abs(terrain.heights_above(points)[inner]).max() < 0.1


def test_heights_on_a_plane_are_exact() -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-5, 5, (5000, 2))
    normal = np.array([0.1, -0.2, 1.0]) / np.linalg.norm([0.1, -0.2, 1.0])
    points = np.column_stack([xy, -(xy @ normal[:2]) / normal[2]])
    terrain = FIT.on(FIT.level(points, np.array([*normal, 0.0])))
    raised = points + 0.4 * normal
    np.testing.assert_allclose(terrain.heights_above(raised), 0.4, atol=1e-6)


def test_a_cloud_in_millimetres_is_named() -> None:
    with pytest.raises(DataError, match="unit is the metre"):
        FIT.on(FIT.level(ground(np.random.default_rng(0)) * 1000, LEVEL))


@pytest.mark.parametrize("most_steps", [40, 2])
@pytest.mark.parametrize("factor", [1.0, 0.3, 100.0])
def test_a_system_near_the_last_one_is_solved_as_if_it_were_the_first(
    monkeypatch: pytest.MonkeyPatch, factor: float, most_steps: int
) -> None:
    """Where few steps do not settle it is factored anew."""
    monkeypatch.setattr(grid_solver, "_MOST_STEPS", most_steps)
    rng = np.random.default_rng(0)
    system, diagonal = _stiff((20, 30), 10.0)
    weights, right, solver = rng.uniform(0, 1, 600), rng.normal(size=600), GridSolver()
    for n in range(3):
        near = system.copy()
        near.data[diagonal] += weights * factor**n
        found = solver.solved(near, right)
        wanted = np.linalg.solve(near.toarray(), right)
        assert np.abs(found - wanted).max() < 1e-9 * np.abs(wanted).max()


@pytest.mark.parametrize("asked_m", [0.5, 1.0])
def test_wide_ground_is_followed_by_nodes_that_are_far_apart(asked_m: float) -> None:
    """The sides of the grid are told by the area; waves are a tenth as high as they are long."""
    rng, side_m = np.random.default_rng(0), 400.0 * asked_m
    xy = rng.uniform(0, side_m, (200_000, 2))
    crests = np.sin(2 * np.pi * xy[:, 0] / (40 * asked_m)) * 0.5
    fit = SurfaceFit(asked_m, margin_m=0.1, max_rise=0.36, stiffness=0.5)
    sample = fit.level(np.column_stack([xy, crests]), LEVEL)
    assert sample.node_m == pytest.approx(2 * asked_m, rel=0.01)
    inner = np.abs(xy - side_m / 2).max(axis=1) < 0.48 * side_m
    assert np.abs(fit.on(sample).heights_above(sample.points)[inner]).max() < 0.05


@pytest.mark.parametrize(
    ("sides_m", "node_m"),
    [((90.0, 90.0), 0.5), ((200.0, 200.0), 1.0), ((1000.0, 1000.0), 2.0), ((1500.0, 1500.0), 3.0)],
)
def test_nodes_are_four_times_as_far_apart_before_there_are_more(
    sides_m: tuple[float, float], node_m: float
) -> None:
    found_m = ground_surface.node_distance_m(np.array(sides_m), 0.5)
    assert found_m == pytest.approx(node_m, rel=0.01)


def test_steps_without_factors_end_where_factors_do() -> None:
    rng = np.random.default_rng(0)
    system, diagonal = _stiff((20, 30), 0.002)
    system.data[diagonal] += 0.03
    right = rng.normal(0, 0.03, 600)
    exact = GridSolver().solved(system, right)
    steps = GridSolver(has_factors=False).solved(system, right)
    np.testing.assert_allclose(steps, exact, atol=1e-3 * np.abs(exact).max())


def test_steps_that_do_not_settle_without_factors_give_way_to_factors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(grid_solver, "_MOST_STEPS_WIDE", 2)
    system, diagonal = _stiff((20, 30), 10.0)
    system.data[diagonal] += 0.03
    right = np.random.default_rng(0).normal(size=600)
    found = GridSolver(has_factors=False).solved(system, right)
    np.testing.assert_allclose(found, np.linalg.solve(system.toarray(), right), rtol=1e-9)
