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
