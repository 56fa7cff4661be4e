"""The three costs of the paper, and the order on costs made by hand."""

import numpy as np
import pytest
from executive_plugins.grasping.sampling.frames import downward_frames
from executive_plugins.grasping.sampling.ranking import paper_costs, ranked_rounds, spread

from executive.geometry.rotation import exp_so3

UP = np.array([0.0, 0.0, 1.0])
STAGES = [("align_rad", 4), ("enclose_m", 2)]


def order(align: list[float], enclose: list[float], distance: list[float]) -> list[list[int]]:
    costs = {
        "align_rad": np.array(align),
        "enclose_m": np.array(enclose),
        "distance_m": np.array(distance),
    }
    return [passed.tolist() for passed in ranked_rounds(costs, STAGES, "distance_m")]


def test_costs_of_a_gripper_straight_above_the_centre() -> None:
    costs = paper_costs(
        downward_frames(np.zeros(1)), np.array([[0.0, 0.0, 2.0]]), np.array([0.0, 0.0, 0.5]), UP
    )
    assert costs["align_rad"][0] == pytest.approx(0.0)
    assert costs["enclose_m"][0] == pytest.approx(1.5)
    assert costs["distance_m"][0] == pytest.approx(0.0)


def test_costs_of_a_tilted_and_shifted_gripper() -> None:
    R = exp_so3(np.array([0.3, 0.0, 0.0])) @ downward_frames(np.zeros(1))
    costs = paper_costs(R, np.array([[0.4, 0.0, 2.0]]), np.array([0.0, 0.0, 0.5]), UP)
    assert costs["align_rad"][0] == pytest.approx(0.3)
    assert costs["enclose_m"][0] == pytest.approx(1.5 * np.cos(0.3))
    assert costs["distance_m"][0] == pytest.approx(np.hypot(0.4, 1.5 * np.sin(0.3)))


def test_each_stage_keeps_its_best_and_the_last_cost_decides() -> None:
    first, *_ = order(
        align=[0.1, 0.2, 0.3, 0.4, 0.9],  # the last does not pass
        enclose=[3.0, 1.0, 4.0, 2.0, 0.0],  # 1 and 3 pass
        distance=[0.0, 0.5, 0.0, 0.4, 0.0],
    )
    assert first == [3, 1]


def test_what_did_not_pass_comes_in_later_rounds_and_nothing_twice() -> None:
    rounds = order([0.1, 0.2, 0.3, 0.4, 0.9], [3.0, 1.0, 4.0, 2.0, 0.0], [0.0, 0.5, 0.0, 0.4, 0.0])
    assert sorted(i for passed in rounds for i in passed) == [0, 1, 2, 3, 4]
    assert [len(passed) for passed in rounds] == [2, 2, 1]


def test_fewer_candidates_than_a_stage_keeps_all_pass() -> None:
    assert order([0.1], [1.0], [1.0]) == [[0]]
    assert order([], [], []) == []


def test_ties_are_ordered_by_the_other_costs_and_then_by_index() -> None:
    assert order([0.1, 0.1], [1.0, 1.0], [0.5, 0.5]) == [[0, 1]]
    assert order([0.2, 0.1], [1.0, 1.0], [0.5, 0.5]) == [[1, 0]]


def test_grasps_that_differ_come_before_repetitions() -> None:
    R = np.tile(downward_frames(np.zeros(1)), (3, 1, 1))
    position = np.array([[0.0, 0, 0], [0.01, 0, 0], [0.5, 0, 0]])
    assert list(spread(range(3), R, position, 0.1, 0.3)) == [0, 2, 1]


def test_half_a_turn_about_the_approach_is_no_difference() -> None:
    R = downward_frames(np.array([0.0, np.pi, np.pi / 2]))
    assert list(spread(range(3), R, np.zeros((3, 3)), 0.1, 0.3)) == [0, 2, 1]


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize(("turn_rad", "is_new"), [(0.0, False), (0.28, False), (0.32, True)])
@pytest.mark.parametrize("is_flipped", [False, True])
def test_grasps_differ_from_a_turn_on_whatever_their_axis(
    seed: int, turn_rad: float, is_new: bool, is_flipped: bool
) -> None:
    """Turned about any axis, and half a turn more about the approach, which does not count."""
    rng = np.random.default_rng(seed)
    R = exp_so3(rng.normal(size=3))
    axis = rng.normal(size=3)
    turned = R @ exp_so3(turn_rad * axis / np.linalg.norm(axis))
    if is_flipped:
        turned = turned @ np.diag([1.0, -1.0, -1.0])
    both = np.stack([R, turned, np.diag([-1.0, 1.0, -1.0]) @ R])
    order = list(spread(range(3), both, np.zeros((3, 3)), 0.1, 0.3))
    assert order.index(1) == (1 if is_new else 2)


@pytest.mark.parametrize(("shift_m", "is_new"), [(0.09, False), (0.11, True)])
def test_grasps_differ_from_a_shift_on(shift_m: float, is_new: bool) -> None:
    R = np.tile(np.eye(3), (3, 1, 1))
    for direction in np.eye(3):
        position = np.array([np.zeros(3), shift_m * direction, -9.0 * direction])
        assert list(spread(range(3), R, position, 0.1, 0.3)) == ([0, 1, 2] if is_new else [0, 2, 1])
