import numpy as np
import pytest
from executive_plugins.driving.dubins import Curve, _turn, curves
from executive_plugins.driving.pieces import Piece, joined

STEP_M = 0.1


def drawn(seed):
    rng = np.random.default_rng(seed)
    place = [rng.uniform(-6, 6), rng.uniform(-6, 6), rng.uniform(-np.pi, np.pi)]
    return np.array(place), rng.permuted(place)


@pytest.mark.parametrize("seed", range(40))
def test_every_word_ends_at_the_goal(seed):
    start, goal = drawn(seed)
    found = list(curves(start, goal, 2.0))
    assert len(found) >= 4  # two words have no solution where the poses are far apart
    for curve in found:
        end = curve.sampled(STEP_M)[0][-1]
        np.testing.assert_allclose(end[:2], goal[:2], atol=1e-9)
        turned = (end[2] - goal[2] + np.pi) % (2 * np.pi) - np.pi
        assert turned == pytest.approx(0.0, abs=1e-9)


def test_a_curve_is_as_long_as_its_samples_and_bends_as_it_says():
    curve = next(curves(np.array([0.0, 0.0, 0.3]), np.array([5.0, 4.0, 2.0]), 2.0))
    poses, curvature = curve.sampled(0.01)
    ways = np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1)
    assert ways.sum() == pytest.approx(curve.length_m, rel=1e-4)
    np.testing.assert_allclose(np.diff(poses[:, 2]) / ways, curvature[1:], atol=1e-4)


def test_no_curve_is_shorter_than_the_straight_line():
    for seed in range(20):
        start, goal = drawn(seed)
        shortest = next(curves(start, goal, 2.0))
        assert shortest.length_m >= np.linalg.norm(goal[:2] - start[:2]) - 1e-9


def test_a_piece_that_is_driven_backwards_keeps_the_heading_of_the_machine():
    away = Curve(np.array([0.0, 0.0, np.pi]), 3.0, (0, 0, 0), (1.0, 0.0, 0.0))
    back = next(curves(np.array([-3.0, 0.0, 0.0]), np.array([3.0, 1.0, 0.2]), 4.0))
    path = joined([Piece(away, -1), Piece(back, 1)], STEP_M)
    assert path.direction[0] == -1
    assert path.direction[-1] == 1
    turn = int(np.flatnonzero(np.diff(path.direction))[0])
    np.testing.assert_allclose(path.poses_map[turn], path.poses_map[turn + 1], atol=1e-9)
    np.testing.assert_allclose(path.poses_map[: turn + 1, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(path.goal_map, [3.0, 1.0, 0.2], atol=1e-9)


def test_a_full_turn_by_rounding_is_none():
    assert _turn(-1e-12) == 0.0
    assert _turn(2 * np.pi - 1e-10) == 0.0
    assert _turn(-1e-6) == pytest.approx(2 * np.pi - 1e-6)
    assert _turn(7.0) == pytest.approx(7.0 - 2 * np.pi)


def test_a_curve_to_where_it_starts_is_one_pose_that_does_not_bend():
    here = np.array([1.0, -2.0, 0.7])
    curve = next(curves(here, here, 2.0))
    assert curve.length_m == pytest.approx(0.0, abs=1e-9)
    poses, curvature = curve.sampled(STEP_M)
    np.testing.assert_array_equal(poses, [here])
    np.testing.assert_array_equal(curvature, [0.0])
