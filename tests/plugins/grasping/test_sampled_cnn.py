"""Whole plans ranked by predicted success."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch
from executive_plugins.grasping import sampled_cnn
from executive_plugins.grasping.classifier import outcome_net
from executive_plugins.grasping.feasibility.fcl_check import FclCheck
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.sampling.pool import Pool
from executive_plugins.grasping.settings import SampledCnnSettings
from executive_plugins.grasping.simulated_lift import FALLEN_M, Lifted, SimulatedLift
from executive_plugins.physics.surface import ContactModel
from pydantic import ValidationError

from executive.arrays import Float
from executive.errors import DataError, ShapeError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis, angle_between
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine
from executive.messages.grasp import GraspPlan

SIDES_M = (1.3, 0.8, 0.65)
HALF_TURN = about_axis(np.array([1.0, 0.0, 0.0]), np.pi)


@pytest.fixture(scope="module")
def plan(
    machine: Machine,
    free_motion: MotionPlanner,
    make_box: Callable,
    make_field: Callable,
    see: Callable,
) -> Callable[..., GraspPlan]:
    slab = make_box(SIDES_M), make_field(without=np.array(SIDES_M[:2]) / 2)

    def planned(
        scene: tuple[Float, Float] = slab, T: Float | None = None, **settings: object
    ) -> GraspPlan:
        planner = SampledCnn(SampledCnnSettings(samples=20, **settings), machine, free_motion)
        planner.start()
        return planner.plan(*see(*scene, T), np.eye(4), np.random.default_rng(0))

    return planned


def test_grasps_come_by_predicted_success(plan: Callable) -> None:
    grasps = plan(rehearsed=0).grasps
    assert len(grasps) == 8
    assert [g.score for g in grasps] == sorted((g.score for g in grasps), reverse=True)
    assert all(g.score == pytest.approx(1 - g.costs["failure"]) for g in grasps)
    best = grasps[0].T_map_gripper
    ahead, across, along = best[:3, :3].T @ (np.array([0.0, 0.0, 0.65 / 2]) - best[:3, 3])
    assert 0.3 < ahead < 1.3
    assert max(abs(across), abs(along)) < 0.3


def test_the_papers_ranking_orders_what_is_predicted_to_succeed_by_distance(plan: Callable) -> None:
    grasps = plan(
        ranking="paper",
        rehearsed=0,
        keep_aligned=5000,
        keep_enclosing=5000,
        downward_yaws=0,
        min_success=0.2,
    ).grasps
    assert grasps[0].costs["failure"] <= 0.8
    accepted = [g.costs["distance_m"] for g in grasps if g.costs["failure"] <= 0.8]
    assert accepted[0] == min(accepted)


def test_when_nothing_is_predicted_to_succeed_the_likeliest_comes_first(plan: Callable) -> None:
    failures = [
        g.costs["failure"] for g in plan(ranking="paper", rehearsed=0, min_success=1.0).grasps
    ]
    assert failures[0] == min(failures)


def test_in_kind_what_slips_when_rehearsed_costs_its_share_of_a_fall(plan: Callable) -> None:
    for grasp in plan(physics="kind").grasps:
        cost = grasp.costs["slip_m"] + 0.2 * grasp.costs["push_m"]
        assert grasp.score == pytest.approx(1 - grasp.costs["failure"] - cost / FALLEN_M, abs=0.011)


def test_every_grasp_is_rehearsed_also_those_for_later_attempts(plan: Callable) -> None:
    grasps = plan().grasps
    assert len(grasps) >= 4
    assert all("slip_m" in grasp.costs for grasp in grasps)


def test_rehearsals_have_the_contacts_that_the_settings_assume(
    plan: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    frictions: list[float] = []

    def lift(_: object, __: Float, ___: float, contact: ContactModel) -> Lifted:
        frictions.append(round(contact.steel.friction, 3))
        return Lifted(0.0, 0.0, 0.0)

    monkeypatch.setattr(SimulatedLift, "lift", lift)
    plan()
    assert 0.25 <= min(frictions) < 0.3 < 0.4 < max(frictions) <= 0.45  # wet to dry
    frictions.clear()
    plan(physics="nominal")
    assert 0.35 <= min(frictions) < max(frictions) <= 0.45
    frictions.clear()
    plan(physics="kind")
    assert set(frictions) == {0.45, 0.55}
    frictions.clear()
    plan(physics="wet")
    assert 0.25 <= min(frictions) < max(frictions) <= 0.35
    frictions.clear()
    plan(physics="wet", steel_friction=(0.2, 0.21))
    assert 0.2 <= min(frictions) < max(frictions) <= 0.21


@pytest.mark.parametrize(
    ("wrong", "told"),
    [({"physics": "icy"}, "nominal"), ({"steel_friction": (0.5, 0.3)}, "least, largest")],
)
def test_contacts_that_do_not_exist_are_refused(wrong: dict[str, object], told: str) -> None:
    with pytest.raises(ValidationError, match=told):
        SampledCnnSettings.model_validate(wrong)


def test_a_grasp_that_falls_when_rehearsed_is_refused(
    plan: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SimulatedLift, "lift", lambda *_: Lifted(FALLEN_M, 0.0, 0.0))
    nothing = plan()
    assert (nothing.grasps, nothing.refused["slips"]) == ((), 12)


def test_a_grasp_below_the_score_that_the_mission_asks_for_is_refused(plan: Callable) -> None:
    scores = [grasp.score for grasp in plan().grasps]
    least = (scores[0] + scores[-1]) / 2
    fewer = plan(min_score=least)
    assert fewer.grasps
    assert all(grasp.score >= least for grasp in fewer.grasps)
    assert fewer.refused["unlikely"] > 0


def test_weights_that_are_missing_are_told_at_the_start(plan: Callable, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="grasp-train"):
        plan(weights=str(tmp_path / "none.safetensors"))


def test_an_unknown_ranking_is_refused() -> None:
    with pytest.raises(ValidationError, match="learned"):
        SampledCnnSettings(ranking="best")


@pytest.fixture
def one_sided(make_box: Callable, make_field: Callable) -> tuple[Float, Float]:
    """A slab of which one end is seen better, with noise: without symmetry, there is one way to
    look at it.
    """
    rng, box, ground = np.random.default_rng(2), make_box(SIDES_M), make_field()
    slab = box[rng.random(len(box)) < np.where(box[:, 0] > 0, 0.9, 0.5)]
    return slab + rng.normal(0, 0.005, slab.shape), ground + rng.normal(0, 0.005, ground.shape)


def test_a_turned_and_shifted_scene_gives_the_same_grasp(plan: Callable, one_sided: tuple) -> None:
    T = pose(about_axis(np.array([0.0, 0.0, 1.0]), 1.1), np.array([7.0, -3.0, 0.4]))
    here = plan(one_sided).grasps[0].T_map_gripper
    there = inverse(T) @ plan(one_sided, T).grasps[0].T_map_gripper
    np.testing.assert_allclose(there[:3, 3], here[:3, 3], atol=0.02)
    assert min(
        angle_between(there[:3, :3], here[:3, :3] @ R) for R in (np.eye(3), HALF_TURN)
    ) < np.radians(2)


def test_one_thread_and_two_give_the_same_list(plan: Callable) -> None:
    threads = torch.get_num_threads()
    try:
        torch.set_num_threads(1)
        one = plan()
        torch.set_num_threads(2)
        two = plan()
    finally:
        torch.set_num_threads(threads)
    assert [g.score for g in one.grasps] == [g.score for g in two.grasps]
    np.testing.assert_array_equal(
        [g.T_map_gripper for g in one.grasps], [g.T_map_gripper for g in two.grasps]
    )


def test_next_to_a_neighbour_and_on_a_slope_no_returned_gripper_stands_in_the_cloud(
    plan: Callable, one_sided: tuple, make_box: Callable, machine: Machine
) -> None:
    stone, ground = one_sided
    tilt = pose(about_axis(np.array([0.6, 0.8, 0.0]), 0.15))
    scene = (
        transform(tilt, stone),
        transform(tilt, np.concatenate([ground, make_box(SIDES_M) + (0.0, 1.1, 0.0)])),
    )
    grasps = plan(scene).grasps
    assert grasps
    recheck = FclCheck(machine.gripper, 0.01)
    assert all(recheck.is_free(np.concatenate(scene), grasp.T_map_gripper) for grasp in grasps)


def test_a_cloud_with_a_point_that_is_no_number_is_refused(
    plan: Callable, one_sided: tuple
) -> None:
    stone, ground = one_sided
    with pytest.raises(ShapeError, match="not finite"):
        plan((stone, np.concatenate([ground, [[0.0, np.nan, 0.0]]])))


@pytest.mark.parametrize(
    ("ranking", "expected"), [("paper", [2, 3, 1, 0, 4]), ("learned", [1, 3, 2, 0, 4])]
)
def test_likely_successes_come_in_the_order_of_the_paper_or_all_by_their_success(
    machine: Machine, monkeypatch: pytest.MonkeyPatch, ranking: str, expected: list[int]
) -> None:
    """Of equal successes the first is the first; the least that is asked for is enough."""
    likely = np.array([0.25, 0.875, 0.5, 0.75, 0.25])
    monkeypatch.setattr(outcome_net, "success", lambda net, features: likely)
    monkeypatch.setattr(outcome_net, "load_net", lambda path: path.name)
    monkeypatch.setattr(sampled_cnn, "features_of", lambda scene, pool, gripper: None)
    settings = SampledCnnSettings(ranking=ranking, min_success=0.5, min_score=0.1)
    planner = SampledCnn(settings, machine, None)  # type: ignore[arg-type]
    costs = {name: np.zeros(5) for name in ("align_rad", "enclose_m")}
    costs["distance_m"] = np.array([0.1, 0.4, 0.2, 0.3, 0.0])
    never = np.zeros(5, dtype=int)
    pool = Pool(np.zeros((5, 3, 3)), np.zeros((5, 3)), np.zeros(5), costs, Counter(), never)
    order = planner.ordered(None, pool)  # type: ignore[arg-type]
    assert list(order.indices) == expected
    np.testing.assert_array_equal(order.costs["failure"], 1 - likely)
    is_paper = ranking == "paper"
    assert order.is_telling is not is_paper
    assert order.least_score == (-np.inf if is_paper else 0.1)
    np.testing.assert_array_equal(order.worth, np.zeros(5) if is_paper else likely)
    assert planner._loaded() == "m545_two_stream.safetensors"
    monkeypatch.setattr(outcome_net, "load_net", None)  # it is loaded once
    assert planner._loaded() == "m545_two_stream.safetensors"
