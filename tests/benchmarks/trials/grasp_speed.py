"""How long a plan takes, how many hypotheses are checked a second (CPU time of one core), and
whether grasps are free.

Generated stones as two lidars of a swinging cabin and, half of them, a drone see them. Hypotheses
that are too steep are left out before anything is checked: the rate counts only those that are
pushed and closed. Refusals are timed on the same stones, made too wide or too heavy.
"""

from collections.abc import Iterator
from itertools import islice
from time import process_time

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.grasping.feasibility.fcl_check import FclCheck
from executive_plugins.grasping.learning.labels import LabelSettings
from executive_plugins.grasping.learning.training_scene import StoneView, look_at
from executive_plugins.grasping.sampled_antipodal import SampledAntipodal
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.sampled_planner import SampledPlanner
from executive_plugins.grasping.sampling.pool import Sampler
from executive_plugins.grasping.sampling.settings import SamplingSettings
from executive_plugins.grasping.settings import SampledAntipodalSettings, SampledCnnSettings

from executive.arrays import Float
from executive.commands.chosen import chosen
from executive.geometry.pose import transform
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.grasp import GraspPlan
from executive.messages.stone import Stone, StoneState
from trials.lone_stones import generated

SEED, SAMPLES = 55, 100
PLAN_S = {"median": Bound(1.0, 0.4), "p95": Bound(2.0, 0.8)}
REFUSAL_S = Bound(1.0)
RATE_HZ = Bound(5000, 15000, is_least=True)
STANDS = np.array([[1, 0, 0, -5.5], [0, 1, 0, 0], [0, 0, 1, 0.9], [0, 0, 0, 1]], dtype=float)


def timed(planner: SampledPlanner, view: StoneView, seed: int) -> tuple[float, GraspPlan]:
    seen = Stone(1, StoneState.ON_GROUND, view.stone, view.stone.mean(axis=0), np.eye(4), True)
    begun_s = process_time()
    plan = planner.plan(seen, Cloud("map", view.cloud), STANDS, np.random.default_rng(seed))
    return process_time() - begun_s, plan


def freedom(planner: SampledPlanner, view: StoneView, seed: int, plan: GraspPlan) -> list[bool]:
    """Return for each grasp of a plan whether it is free in the planning cloud that the same seed
    gives.
    """
    gripper = load_machine("m545").gripper
    scene = Sampler(SamplingSettings(), gripper).scene(
        view.stone, view.cloud, np.random.default_rng(seed)
    )
    points = transform(scene.T_map_plan, scene.points)
    return [FclCheck(gripper, 0.01).is_free(points, grasp.T_map_gripper) for grasp in plan.grasps]


def scaled(view: StoneView, factors: Float) -> StoneView:
    return StoneView(view.stone * factors, np.concatenate([view.cloud, view.stone * factors]))


def line(name: str, values: list[float], unit: str) -> str:
    middle, high = np.percentile(values, [50, 95])
    return (
        f"  {name:34} median {middle:8.3g}, p95 {high:8.3g}, most {max(values):8.3g} {unit} "
        f" (n = {len(values)})"
    )


def planned(planners: dict[str, SampledPlanner], views: list[StoneView]) -> Iterator[Figure]:
    """Time whole plans of each planner, and look whether their grasps are free."""
    for name, planner in planners.items():
        timed(planner, views[0], 0)
        results = [timed(planner, view, i) for i, view in enumerate(views)]
        spans = [span for span, _ in results]
        print(line(f"plan, {name}", spans, "s"), flush=True)
        free = [
            is_free
            for i, (_, plan) in enumerate(results)
            for is_free in freedom(planner, views[i], i, plan)
        ]
        deep = len(free) - sum(free)
        yield held(f"plan, {name}: median [s]", float(np.median(spans)), PLAN_S["median"])
        yield held(f"plan, {name}: p95 [s]", float(np.percentile(spans, 95)), PLAN_S["p95"])
        yield held(
            f"{name}: grasps deeper than 1 cm in the planning cloud",
            deep,
            Bound(0),
            f"{deep} of {len(free)}",
        )


def refused(planner: SampledPlanner, views: list[StoneView]) -> Iterator[Figure]:
    """Time refusals of stones that are too heavy or too wide."""
    for name, factors in (("too heavy", (1.0, 1.0, 3.0)), ("too wide", (2.6, 2.6, 0.3))):
        results = [timed(planner, scaled(v, np.array(factors)), i) for i, v in enumerate(views)]
        spans = [span for span, plan in results if not plan.grasps] or [np.nan]
        print(line(f"refusal: {name}", spans, "s"))
        yield held(f"refusal, {name}: longest [s]", max(spans), REFUSAL_S)


def hypotheses(machine: Machine, views: list[StoneView]) -> Figure:
    """Count the hypotheses that are pushed and closed in a second."""
    sampler, counts, rates = Sampler(SamplingSettings(samples=SAMPLES), machine.gripper), [], []
    for i, view in enumerate(views):
        rng = np.random.default_rng(i)
        scene = sampler.scene(view.stone, view.cloud, rng)
        begun_s = process_time()
        pool = sampler.pool(scene, rng)
        pushed = len(pool) + sum(n for reason, n in pool.refused.items() if reason != "too_steep")
        rates.append(pushed / (process_time() - begun_s))
        counts.append(float(len(scene.points)))
    print(line("points of the planning cloud", counts, ""))
    print(line("hypotheses pushed and closed", rates, "a second"))
    return held("hypotheses pushed and closed, median [1/s]", float(np.median(rates)), RATE_HZ)


def measured(stones: int) -> list[Figure]:
    """Measure on so many generated stones."""
    machine = load_machine("m545")
    solids = islice(generated(LabelSettings(), SEED), stones)
    views = [
        look_at(solid, (), np.random.default_rng((SEED, i))) for i, (_, solid) in enumerate(solids)
    ]
    with chosen(MotionPlanner) as motion:
        planners: dict[str, SampledPlanner] = {
            "sampled_cnn": SampledCnn(SampledCnnSettings(samples=SAMPLES), machine, motion),
            "sampled_antipodal": SampledAntipodal(
                SampledAntipodalSettings(samples=SAMPLES), machine, motion
            ),
        }
        for planner in planners.values():
            planner.start()
        found = [*planned(planners, views), *refused(planners["sampled_cnn"], views)]
    return [*found, hypotheses(machine, views)]
