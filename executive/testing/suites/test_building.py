"""What every building planner must do, whatever its method."""

import numpy as np

from executive.interfaces.building import StructurePlanner
from executive.messages.building import BuildPlan, BuildTarget
from executive.testing.exercises.building import bare, boxes, first_course
from executive.testing.pytest_plugin import Insist

CAPABILITY = "building"


def test_a_stone_is_put_on_the_ground_of_a_bare_structure(
    plugin: StructurePlanner, insist: Insist
) -> None:
    plan = plugin.propose(bare(), boxes(), np.random.default_rng(0))
    insist(plan.targets, f"it finds no place on level ground: {plan.reason}")
    _hold(plan)
    stone = {one.name: one for one in boxes()}[plan.targets[0].stone]
    T = plan.targets[0].T_map_settled
    lowest = (stone.vertices @ T[:3, :3].T + T[:3, 3])[:, 2].min()
    assert abs(lowest) < 0.05  # on the ground: neither in the air nor sunk in


def test_a_stone_on_a_full_course_is_stacked_or_refused_with_a_reason(
    plugin: StructurePlanner,
) -> None:
    plan = plugin.propose(first_course(), boxes(), np.random.default_rng(0))
    _hold(plan)
    for target in plan.targets:
        assert target.T_map_settled[2, 3] > 0.4  # its middle is above the course's top


def test_no_stones_give_a_reason(plugin: StructurePlanner) -> None:
    plan = plugin.propose(bare(), (), np.random.default_rng(0))
    assert plan.reason == "no_stones"
    _hold(plan)


def test_a_planner_without_time_ends(plugin: StructurePlanner) -> None:
    _hold(plugin.propose(bare(), boxes(), np.random.default_rng(0), lambda: False))


def _hold(plan: BuildPlan) -> None:
    """Check what holds for every plan: targets or a reason, rigid poses, the best first."""
    assert bool(plan.targets) == (plan.reason is None)
    scores = [target.score for target in plan.targets]
    assert scores == sorted(scores, reverse=True)
    for target in plan.targets:
        _hold_target(target)


def _hold_target(target: BuildTarget) -> None:
    assert target.stone in {stone.name for stone in boxes()}
    assert target.release_height_m >= 0
    np.testing.assert_allclose(np.linalg.norm(target.approach_map), 1.0, atol=1e-9)
    for T in (target.T_map_stone, target.T_map_settled):
        np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-6)
        assert np.linalg.det(T[:3, :3]) > 0
