"""Whole plans ranked by predicted success."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from executive.arrays import Float
from executive.errors import DataError
from executive.interfaces.motion import MotionPlanner
from executive.messages.grasp import GraspPlan
from executive.messages.request import MotionPlan, MoveRequest
from plugins.grasping.sampled_cnn import SampledCnn, SampledCnnSettings
from robot_models.machine import Machine


class FreeMotion(MotionPlanner):
    """Reaches everything."""

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        return seed

    def move(self, request: MoveRequest) -> MotionPlan:
        raise NotImplementedError

    def swing(self, start: Float, angle_rad: float, duration_s: float) -> MotionPlan:
        raise NotImplementedError


@pytest.fixture(scope="module")
def plan(machine: Machine, make_box: Callable, make_field: Callable, see: Callable) -> Callable[..., GraspPlan]:
    scene = see(make_box((1.3, 0.8, 0.65)), make_field(without=np.array((0.65, 0.4))))

    def planned(**settings: object) -> GraspPlan:
        planner = SampledCnn(SampledCnnSettings(samples=20, **settings), machine, FreeMotion())
        planner.start()
        return planner.plan(*scene, np.eye(4), np.random.default_rng(0))

    return planned


def test_grasps_come_by_predicted_success(plan: Callable) -> None:
    grasps = plan().grasps
    assert len(grasps) == 8
    assert [g.score for g in grasps] == sorted((g.score for g in grasps), reverse=True)
    assert all(g.score == pytest.approx(1 - g.costs["failure"]) for g in grasps)
    best = grasps[0].T_map_gripper
    ahead, across, along = best[:3, :3].T @ (np.array([0.0, 0.0, 0.65 / 2]) - best[:3, 3])
    assert 0.3 < ahead < 1.3
    assert max(abs(across), abs(along)) < 0.3


def test_the_papers_ranking_orders_what_is_predicted_to_succeed_by_distance(plan: Callable) -> None:
    grasps = plan(ranking="paper", keep_aligned=5000, keep_enclosing=5000, downward_yaws=0, min_success=0.2).grasps
    assert grasps[0].costs["failure"] <= 0.8
    accepted = [g.costs["distance_m"] for g in grasps if g.costs["failure"] <= 0.8]
    assert accepted[0] == min(accepted)


def test_when_nothing_is_predicted_to_succeed_the_likeliest_comes_first(plan: Callable) -> None:
    failures = [g.costs["failure"] for g in plan(ranking="paper", min_success=1.0).grasps]
    assert failures[0] == min(failures)


def test_rehearsals_on_top_take_their_slip_off_the_score(plan: Callable) -> None:
    for grasp in plan(rehearsed=2, max_grasps=2).grasps:
        cost = grasp.costs["slip_m"] + 0.2 * grasp.costs["push_m"]
        assert grasp.score == pytest.approx(1 - grasp.costs["failure"] - cost, abs=0.006)


def test_weights_that_are_missing_are_told_at_the_start(plan: Callable, tmp_path: Path) -> None:
    with pytest.raises(DataError, match="grasp-train"):
        plan(weights=str(tmp_path / "none.safetensors"))


def test_an_unknown_ranking_is_refused() -> None:
    with pytest.raises(ValidationError, match="learned"):
        SampledCnnSettings(ranking="best")
