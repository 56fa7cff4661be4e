"""Whole plans, on stones whose good grasps are plain."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.grasping.feasibility.approach_path import ApproachPath
from executive_plugins.grasping.feasibility.fcl_check import FclCheck
from executive_plugins.grasping.sampled_antipodal import SampledAntipodal
from executive_plugins.grasping.sampling import closing
from executive_plugins.grasping.settings import SampledAntipodalSettings

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis, angle_between
from executive.interfaces.motion import MotionPlanner
from executive.machine.gripper import Gripper
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.grasp import GraspPlan
from executive.messages.weight import Weight

SIDES_M = (1.3, 0.8, 0.65)
HALF_TURN = about_axis(np.array([1.0, 0.0, 0.0]), np.pi)


def plan(planner: SampledAntipodal, scene: tuple, seed: int = 0) -> GraspPlan:
    return planner.plan(*scene, np.eye(4), np.random.default_rng(seed))


@pytest.fixture(scope="module")
def planner(planner_of: Callable) -> SampledAntipodal:
    return planner_of(samples=30, rehearsed=8, physics="kind")


@pytest.fixture(scope="module")
def scene(make_box: Callable, make_field: Callable, see: Callable) -> tuple:
    return see(make_box(SIDES_M), make_field(without=np.array(SIDES_M[:2]) / 2))


@pytest.fixture(scope="module")
def one_sided(make_box: Callable) -> Float:
    """A slab of which one end is seen better: without symmetry, there is one way to look at it."""
    rng = np.random.default_rng(2)
    box = make_box(SIDES_M)
    return np.asarray(box[rng.random(len(box)) < np.where(box[:, 0] > 0, 0.9, 0.5)])


def test_a_slab_is_grasped_from_above_near_its_centre_without_slipping(
    planner: SampledAntipodal, scene: tuple
) -> None:
    best = plan(planner, scene).grasps[0]
    assert best.T_map_gripper[2, 0] < -0.95
    np.testing.assert_allclose(best.T_map_gripper[:2, 3], 0.0, atol=0.2)
    assert best.costs["slip_m"] < 0.05
    assert {"align_rad", "enclose_m", "distance_m"} <= set(best.costs)


def test_no_returned_gripper_stands_in_the_cloud(
    planner: SampledAntipodal, scene: tuple, gripper: Gripper
) -> None:
    for grasp in plan(planner, scene).grasps:
        assert ApproachPath(gripper).depth_m(scene[1].points, grasp.T_map_gripper) < 0.01
        assert FclCheck(gripper, 0.01).is_free(scene[1].points, grasp.T_map_gripper)


def test_grasps_come_best_first_and_differ(planner: SampledAntipodal, scene: tuple) -> None:
    grasps = plan(planner, scene).grasps
    assert len(grasps) >= 3
    assert [g.score for g in grasps] == sorted((g.score for g in grasps), reverse=True)
    first, second = grasps[0].T_map_gripper, grasps[1].T_map_gripper
    turn = min(
        angle_between(first[:3, :3], second[:3, :3]),
        angle_between(first[:3, :3] @ HALF_TURN, second[:3, :3]),
    )
    assert np.linalg.norm(first[:3, 3] - second[:3, 3]) > 0.1 or turn > np.radians(20)


def test_one_seed_gives_one_plan(planner: SampledAntipodal, scene: tuple) -> None:
    a, b = plan(planner, scene, 7), plan(planner, scene, 7)
    assert a.refused == b.refused
    np.testing.assert_array_equal(
        [g.T_map_gripper for g in a.grasps], [g.T_map_gripper for g in b.grasps]
    )


def test_a_turned_and_shifted_scene_gives_the_same_grasp(
    planner: SampledAntipodal, one_sided: Float, make_field: Callable, see: Callable
) -> None:
    T = pose(about_axis(np.array([0.0, 0.0, 1.0]), 1.1), np.array([7.0, -3.0, 0.4]))
    here = plan(planner, see(one_sided, make_field())).grasps[0].T_map_gripper
    there = inverse(T) @ plan(planner, see(one_sided, make_field(), T)).grasps[0].T_map_gripper
    np.testing.assert_allclose(there[:3, 3], here[:3, 3], atol=0.02)
    assert min(
        angle_between(there[:3, :3], here[:3, :3] @ R) for R in (np.eye(3), HALF_TURN)
    ) < np.radians(2)


def test_a_neighbour_at_0_3_m_is_avoided(
    planner: SampledAntipodal,
    make_box: Callable,
    make_field: Callable,
    see: Callable,
    gripper: Gripper,
) -> None:
    box = make_box((0.8, 0.8, 0.7))
    neighbour = box + (1.1, 0.0, 0.0)
    grasps = plan(planner, see(box, np.concatenate([neighbour, make_field()]))).grasps
    assert grasps
    assert (
        max(ApproachPath(gripper).depth_m(neighbour, grasp.T_map_gripper) for grasp in grasps)
        < 0.01
    )


@pytest.mark.parametrize(
    ("sides_m", "reason"),
    [
        ((1.4, 1.4, 0.8), "too_heavy"),
        ((2.6, 2.6, 0.12), "wider_than_opening"),
        ((2.0, 2.0, 0.12), "slips"),
        ((0.6, 0.6, 0.08), "tips_too_high"),
    ],
)
def test_what_cannot_be_held_on_rock_gives_an_empty_plan_with_its_reason(
    planner_of: Callable,
    make_box: Callable,
    make_field: Callable,
    see: Callable,
    sides_m: tuple,
    reason: str,
) -> None:
    planner = planner_of(into_soil_m=0.0)
    refused = plan(planner, see(make_box(sides_m, 0.03), make_field()))
    assert refused.grasps == ()
    assert refused.refused[reason] > 0


def test_a_slab_that_lies_on_soil_is_held_by_tips_below_it(
    planner: SampledAntipodal, make_box: Callable, make_field: Callable, see: Callable
) -> None:
    slab = see(make_box((0.6, 0.6, 0.08), 0.03), make_field())
    assert plan(planner, slab).grasps


def test_grasps_above_the_ground_come_besides_those_that_go_into_it(
    planner_of: Callable, scene: tuple, gripper: Gripper
) -> None:
    def lowest_m(grasps: tuple) -> Float:
        """Return the height of the lowest tip of each grasp, closed as far as it goes."""
        tips = gripper.tips(0.0)
        return np.array([transform(one.T_map_gripper, tips)[:, 2].min() for one in grasps])

    deep = plan(planner_of(samples=30, rehearsed=8, physics="kind"), scene).grasps
    both = plan(
        planner_of(samples=30, rehearsed=8, physics="kind", also_above_ground=True), scene
    ).grasps
    assert len(both) > len(deep)
    assert [one.score for one in both] == sorted((one.score for one in both), reverse=True)
    assert lowest_m(deep).min() < -0.02
    assert lowest_m(both).min() < -0.02 < lowest_m(both).max()
    assert (lowest_m(both) > -0.02).sum() > (lowest_m(deep) > -0.02).sum()


def test_a_stone_out_of_reach_is_refused_as_such(planner_of: Callable, scene: tuple) -> None:
    planner = planner_of(reach_m=3.0, samples=10, rehearsed=4)
    stone, cloud = scene
    far = planner.plan(stone, cloud, pose(t=np.array([5.0, 0.0, 0.0])), np.random.default_rng(0))
    assert far.grasps == ()
    assert far.refused["out_of_reach"] > 0


def test_an_arm_too_weak_for_the_stone_out_there_refuses_it_as_such(
    machine: Machine, free_motion: MotionPlanner, scene: tuple
) -> None:
    joints = tuple(
        joint.model_copy(update={"max_effort": 0.1 * joint.max_effort}) for joint in machine.joints
    )
    weak = machine.model_copy(update={"joints": joints})
    planner = SampledAntipodal(SampledAntipodalSettings(samples=10, rehearsed=0), weak, free_motion)
    refused = plan(planner, scene)
    assert refused.grasps == ()
    assert refused.refused["too_heavy_at_radius"] > 0


def test_a_plan_compiles_nothing_that_the_start_has_not(
    machine: Machine, free_motion: MotionPlanner, scene: tuple
) -> None:
    planner = SampledAntipodal(
        SampledAntipodalSettings(samples=10, rehearsed=0), machine, free_motion
    )
    planner.start()
    compiled = len(closing._try_all.signatures)
    plan(planner, scene)
    assert len(closing._try_all.signatures) == compiled > 0


def test_too_few_points_are_refused(planner: SampledAntipodal, scene: tuple, see: Callable) -> None:
    stone, cloud = scene
    assert plan(planner, see(stone.points_map[:5], cloud.points)).refused == {"too_few_points": 1}


def test_duplicated_points_change_nothing(
    planner: SampledAntipodal, one_sided: Float, make_field: Callable, see: Callable
) -> None:
    twice = see(np.repeat(one_sided, 2, axis=0), np.repeat(make_field(), 2, axis=0))
    a, b = plan(planner, see(one_sided, make_field())), plan(planner, twice)
    np.testing.assert_allclose(a.grasps[0].T_map_gripper, b.grasps[0].T_map_gripper, atol=1e-6)


def test_a_cloud_in_another_frame_is_refused(planner: SampledAntipodal, scene: tuple) -> None:
    with pytest.raises(DataError, match="frame 'map', got 'drone'"):
        plan(planner, (scene[0], Cloud("drone", scene[1].points)))


def test_without_rehearsals_the_order_is_the_papers(planner_of: Callable, scene: tuple) -> None:
    plain = plan(
        planner_of(samples=10, rehearsed=0, downward_yaws=0, keep_enclosing=500, keep_aligned=500),
        scene,
    )
    distances = [grasp.costs["distance_m"] for grasp in plain.grasps]
    assert distances
    assert all("slip_m" not in grasp.costs for grasp in plain.grasps)
    assert distances[0] == min(distances)


def test_a_stone_that_was_weighed_is_judged_by_its_weight_and_the_message_has_it(
    planner_of: Callable, scene: tuple, machine: Machine
) -> None:
    planner = planner_of(samples=10, rehearsed=0)
    stone, cloud = scene
    heavy = replace(stone, weight=Weight(machine.payload_kg + 300.0, 50.0))
    plan = planner.plan(heavy, cloud, np.eye(4), np.random.default_rng(0))
    assert (plan.grasps, dict(plan.refused), plan.is_final) == ((), {"too_heavy": 1}, True)
    limit = f"{machine.payload_kg:.0f} kg"
    assert f"weighed: 3300 ± 50 kg, and the gripper lifts {limit}" in plan.detail
    light = replace(stone, weight=Weight(machine.payload_kg - 300.0, 50.0))
    assert planner.plan(light, cloud, np.eye(4), np.random.default_rng(0)).grasps


@pytest.mark.parametrize(
    ("rule", "is_free", "is_refused"),
    [
        ("payload", True, False),
        ("iso_10567", False, True),
        ("by_base", True, True),
        ("by_base", False, False),
    ],
)
def test_a_lift_that_would_tip_the_machine_is_refused_on_request_or_where_it_may_tip(
    machine: Machine,
    free_motion: MotionPlanner,
    scene: tuple,
    rule: str,
    is_free: bool,
    is_refused: bool,
) -> None:
    narrow = ((0.5, 0.3), (0.5, -0.3), (-0.5, 0.3), (-0.5, -0.3))
    stance = machine.stance.model_copy(update={"supports_m": narrow, "is_free": is_free})
    settings = SampledAntipodalSettings(samples=10, rehearsed=0, lift_capacity=rule)
    planner = SampledAntipodal(settings, machine.model_copy(update={"stance": stance}), free_motion)
    answer = plan(planner, scene)
    assert bool(answer.grasps) == (not is_refused)
    assert ("beyond_lift_capacity" in answer.refused) == is_refused
    assert ("that tip the machine, ISO 10567" in answer.detail) == is_refused


def test_an_order_by_the_papers_rule_says_nothing_of_what_a_lift_will_show(
    planner: SampledAntipodal, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(planner, "paper_order", lambda pool: np.array([2, 0, 1]))
    order = planner.ordered(None, range(3))
    assert [*order.indices] == [2, 0, 1]
    assert [*order.worth] == [0.0, 0.0, 0.0]
    assert (order.costs, order.is_telling) == ({}, False)
