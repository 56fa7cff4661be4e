"""How often the first-ranked grasp of a whole plan lifts, by ranking."""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.grasping.learning.labels import LabelSettings
from executive_plugins.grasping.learning.lift_trials import LiftTrials
from executive_plugins.grasping.learning.training_scene import Solid, look_at
from executive_plugins.grasping.sampled_antipodal import SampledAntipodal
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.settings import SampledAntipodalSettings, SampledCnnSettings
from executive_plugins.grasping.simulated_lift import LIFTED_M

from executive.arrays import Float
from executive.clock import wall_s
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.stone import Stone, StoneState
from trials.lone_stones import generated, scanned

SEED, LIFTS = 77, 4
NETWORKS = ("two_stream", "four_layer")
HELD, PAPER = "learned two_stream", "paper"
ABOVE_THE_PAPER = Bound(10, 15, is_least=True)  # points, of the same pools


class FreeMotion(MotionPlanner):
    """Reach every pose: the ranking is measured, not the arm."""

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        return seed

    def move(self, request: MoveRequest) -> MotionPlan:
        raise NotImplementedError

    def swing(self, start: Float, angle_rad: float, duration_s: float) -> MotionPlan:
        raise NotImplementedError


def rankings(machine: Machine) -> dict[str, GraspPlanner]:
    plain, motion = SampledAntipodalSettings, FreeMotion()
    planners: dict[str, GraspPlanner] = {
        "paper": SampledAntipodal(plain(rehearsed=0), machine, motion),
        "rehearsal": SampledAntipodal(plain(), machine, motion),
    }
    for name in NETWORKS:
        planners[f"learned {name}"] = SampledCnn(SampledCnnSettings(weights=name), machine, motion)
    planners["paper after two_stream"] = SampledCnn(
        SampledCnnSettings(ranking="paper"), machine, motion
    )
    planners["learned, 8 rehearsed"] = SampledCnn(SampledCnnSettings(rehearsed=8), machine, motion)
    return planners


def interval(rates: Float) -> tuple[float, float]:
    """Return the 95 % interval of the mean by bootstrap over stones."""
    draws = np.random.default_rng(0).integers(len(rates), size=(4000, len(rates)))
    return tuple(np.percentile(rates[draws].mean(axis=1), [2.5, 97.5]))


def measure(kind: str, stones: Iterator[tuple[Float, Solid]]) -> Figure:
    machine = load_machine("m545")
    gripper, planners = machine.gripper, rankings(machine)
    lifted: dict[str, list[float]] = {name: [] for name in planners}
    spans: dict[str, list[float]] = {name: [] for name in planners}
    for i, (hull, solid) in enumerate(stones):
        view, trials = (
            look_at(solid, (), np.random.default_rng((SEED, i, 1))),
            LiftTrials(gripper, hull),
        )
        seen = Stone(1, StoneState.ON_GROUND, view.stone, view.stone.mean(axis=0), np.eye(4), True)
        for name, planner in planners.items():
            begun_s = wall_s()
            plan = planner.plan(seen, Cloud("map", view.cloud), np.eye(4), np.random.default_rng(i))
            spans[name].append(wall_s() - begun_s)
            chance = np.random.default_rng((SEED, i, 2))
            slips = [
                trials.lift(g.T_map_gripper, gripper.open_rad, chance)
                for g in plan.grasps[:1] * LIFTS
            ]
            lifted[name].append(float(np.mean(np.array(slips) <= LIFTED_M)) if slips else 0.0)
    print(f"\n{kind}: {len(lifted['paper'])} stones, {LIFTS} lifts of each first-ranked grasp")
    for name, rates in lifted.items():
        low, high = interval(np.array(rates))
        span = f"median plan {np.median(spans[name]):.2f} s"
        print(
            f"  {name:24} {100 * np.mean(rates):5.1f} %  [{100 * low:.0f}, "
            f"{100 * high:.0f}]  {span}",
            flush=True,
        )
    more = 100 * (np.array(lifted[HELD]) - np.array(lifted[PAPER]))
    low, high = interval(more)
    return held(
        f"{kind}: {HELD} above the paper's order [points]",
        float(more.mean()),
        ABOVE_THE_PAPER,
        f"{more.mean():.1f} [{low:.0f}, {high:.0f}]",
    )


def measured(stones: int, scans: Path | None) -> list[Figure]:
    """Compare the rankings on generated stones, and on the scans of a folder where one is given."""
    found = [measure("generated", islice(generated(LabelSettings(), SEED), stones))]
    if scans is not None:
        found.append(measure("scanned", islice(scanned(scans, SEED), stones)))
    return found
