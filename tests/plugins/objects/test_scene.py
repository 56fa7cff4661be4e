"""What the map shows beside the models of stones: boxes of points on a flat site."""

import numpy as np
import pytest
from executive_plugins.objects.scene import surface_within, surroundings, unexplained

from executive.arrays import Float
from executive.messages.stone import Stone, StoneState

CELL_M, GROUND_M, NEAR_M = 0.1, 0.15, 0.05
LYING, HELD = StoneState.ON_GROUND, StoneState.HELD


def box(x: float, low: float = 0.0, side_m: float = 0.6, high_m: float = 0.6) -> Float:
    """Return the points of a box, 10 cm apart, its middle at x and its foot at a height."""
    steps = np.arange(0.0, side_m + 1e-9, 0.1) - side_m / 2
    grid = np.meshgrid(x + steps, steps, np.arange(low, low + high_m + 1e-9, 0.1))
    return np.stack(grid, axis=-1).reshape(-1, 3)


def stone(number: int, points: Float, state: StoneState = LYING) -> Stone:
    return Stone(number, state, points, points.mean(axis=0), np.eye(4), False)


def rows(points: Float) -> set[tuple[float, ...]]:
    return {tuple(point) for point in np.round(points, 6).tolist()}


def test_points_on_a_neighbour_are_explained_but_for_its_foot_and_what_is_beside() -> None:
    model = box(0.0)
    beside = model + [3.0, 0.0, 0.0]
    shifted = model + [0.04, 0.0, 0.0]  # as a map shows it, within 5 cm
    left = unexplained(np.vstack([shifted, beside]), [stone(1, model)], NEAR_M, GROUND_M)
    foot = shifted[shifted[:, 2] <= GROUND_M]
    outside, inside = foot[foot[:, 0] > 0.31], foot[(np.abs(foot[:, :2]) < 0.29).all(axis=1)]
    assert rows(np.vstack([outside, beside])) <= rows(left) <= rows(np.vstack([foot, beside]))
    assert not rows(inside) & rows(left)  # ground there would be hidden
    far = unexplained(model + [0.0, 0.0, 0.06], [stone(1, model)], NEAR_M, GROUND_M)
    assert (far[:, 2] > 0.6).any()  # the uppermost are 6 cm from the model


def test_the_foot_of_a_stone_that_rests_on_another_is_no_ground() -> None:
    below, above = box(0.0), box(0.0, low=0.6)
    points = np.vstack([below, above])
    left = unexplained(points, [stone(1, below), stone(2, above)], NEAR_M, GROUND_M)
    assert (left[:, 2] <= GROUND_M).all()
    # The same where the lower one is the stone that is looked at.
    left = unexplained(points, [stone(2, above)], NEAR_M, GROUND_M, own=stone(1, below))
    assert rows(left) == rows(below[below[:, 2] < 0.55])  # where they touch, it is the upper one's


def test_ground_that_was_seen_before_a_neighbour_stood_there_is_hidden_by_it() -> None:
    """Else a stone on top of it would hang above ground that is seen, as a structure does."""
    x, y = np.meshgrid(np.arange(-2.0, 2.0, 0.1), np.arange(-2.0, 2.0, 0.1))
    ground = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    upper = box(0.0, low=0.6)
    points = np.vstack([ground, upper])
    left = unexplained(points, [stone(1, box(0.0))], NEAR_M, GROUND_M, own=stone(2, upper))
    is_below = (np.abs(left[:, :2]) < 0.29).all(axis=1) & (left[:, 2] < 0.3)
    assert not is_below.any()
    beside = ground[(np.abs(ground[:, :2]) > 0.31).any(axis=1)]
    assert rows(beside) <= rows(left)
    # What is below a neighbour that rests on another stone is not its ground.
    left = unexplained(points, [stone(2, upper)], NEAR_M, GROUND_M, own=stone(1, box(0.0)))
    assert rows(ground) <= rows(left)


@pytest.mark.parametrize(
    ("x", "low", "rests"),
    [
        (0.0, 0.6, True),
        (0.3, 0.6, True),  # half of it is over the other
        (0.9, 0.6, False),  # it is beside it
        (0.0, 0.1, False),  # its foot is no deeper than ground may be uneven
    ],
)
def test_a_stone_rests_on_what_is_below_it_and_reaches_farther_down(
    x: float, low: float, rests: bool
) -> None:
    upper, own = box(x, low), stone(1, box(0.0))
    left = unexplained(upper, [stone(2, upper)], NEAR_M, GROUND_M, own=own)
    assert (len(left) == 0) is rests


def test_a_stone_of_which_a_line_is_known_rests_on_nothing() -> None:
    line = np.column_stack([np.linspace(-0.2, 0.2, 5), np.zeros(5), np.full(5, 0.6)])
    left = unexplained(line, [stone(2, line)], NEAR_M, GROUND_M, own=stone(1, box(0.0)))
    assert len(left) == 5


def test_an_empty_map_has_nothing_to_explain() -> None:
    assert len(unexplained(np.zeros((0, 3)), [stone(1, box(0.0))], NEAR_M, GROUND_M)) == 0


def test_surroundings_are_the_map_and_the_stones_that_lie_there() -> None:
    ground = box(0.0, side_m=2.0, high_m=0.0)
    stones = [stone(1, box(5.0)), stone(2, box(8.0), HELD), stone(3, box(11.0))]
    found = surroundings(ground, stones, None, CELL_M, GROUND_M)
    middles = np.unique(np.round(found[:, 0]))
    assert {5.0, 11.0} <= set(middles)
    assert not ((found[:, 0] > 7.0) & (found[:, 0] < 9.0)).any()  # what is held lies nowhere
    assert (np.abs(found[:, 0]) < 1.1).any()
    cells, counts = np.unique(np.floor(found / CELL_M + 1e-6), axis=0, return_counts=True)
    assert counts.max() <= 2  # one a cell, but for places on a border between two
    assert len(cells) > 300


def test_a_stone_is_left_out_with_what_the_map_shows_of_it_above_the_ground() -> None:
    own = stone(1, box(5.0))
    ground = box(5.0, side_m=2.0, high_m=0.0)
    points = np.vstack([ground, box(5.0), box(8.0)])
    found = surroundings(points, [own, stone(2, box(8.0))], own, CELL_M, GROUND_M)
    inside = (np.abs(found[:, 0] - 5.0) < 0.25) & (np.abs(found[:, 1]) < 0.25)
    assert inside.any()  # the ground that it lies on
    assert found[inside, 2].max() <= GROUND_M
    assert found[np.abs(found[:, 0] - 8.0) < 0.5, 2].max() == pytest.approx(0.6, abs=CELL_M)


def test_models_within_a_sphere_are_those_at_most_so_far() -> None:
    near = stone(1, np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.1, 0.0, 0.0]]))
    far = stone(2, np.array([[0.0, 0.0, 9.0], [0.0, 0.0, 2.0]]))
    found = surface_within([near, far], np.zeros(3), 2.0)
    np.testing.assert_array_equal(found, [[1.0, 0, 0], [2.0, 0, 0], [0, 0, 2.0]])
    assert surface_within([], np.zeros(3), 2.0).shape == (0, 3)
