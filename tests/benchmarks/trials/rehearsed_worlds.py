"""How often the first-ranked grasp lifts in a scenario, by the contacts that rehearsals assumed."""

import math
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.grasping.learning.labels import LabelSettings
from executive_plugins.grasping.learning.lift_trials import LiftTrials
from executive_plugins.grasping.learning.training_scene import Solid, look_at
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.settings import SampledCnnSettings
from executive_plugins.grasping.simulated_lift import LIFTED_M
from executive_plugins.physics.scenario import Scenario

from executive.arrays import Float
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState
from trials.grasp_ranking import FreeMotion, interval
from trials.lone_stones import generated, scanned

BELIEFS: tuple[Scenario, ...] = ("kind", "nominal", "wet", "harsh")
WORLDS: tuple[Scenario, ...] = ("nominal", "wet", "harsh")
LIFTS = 4
NO_LESS = Bound(0.0, 5.0, is_least=True)  # points that one's own contacts are above `kind`
ERROR_M, ERROR_RAD = 0.05, math.radians(5)  # as those of `LiftTrials`
MACHINE = load_machine("m545")


def first_picks(
    solid: Solid, seed: tuple[int, int], planners: dict[Scenario, SampledCnn]
) -> dict[Scenario, Float | None]:
    """Return the first-ranked pose of the gripper by the belief, or None of an empty plan."""
    view = look_at(solid, (), np.random.default_rng((*seed, 1)))
    seen = Stone(1, StoneState.ON_GROUND, view.stone, view.stone.mean(axis=0), np.eye(4), True)
    cloud = Cloud("map", view.cloud)
    plans = {
        belief: planner.plan(seen, cloud, np.eye(4), np.random.default_rng(seed))
        for belief, planner in planners.items()
    }
    return {b: plan.grasps[0].T_map_gripper if plan.grasps else None for b, plan in plans.items()}


def lifted_share(
    world: Scenario, hull: Float, T_map_gripper: Float | None, seed: tuple[int, int]
) -> float:
    """Return the share of lifts in a world that hold; 0 where nothing was planned."""
    if T_map_gripper is None:
        return 0.0
    trials, chance = LiftTrials(MACHINE.gripper, hull, world), np.random.default_rng((*seed, 2))
    slips = [trials.lift(T_map_gripper, MACHINE.gripper.open_rad, chance) for _ in range(LIFTS)]
    return float(np.mean(np.array(slips) <= LIFTED_M))


def measure(kind: str, stones: Iterator[tuple[Float, Solid]], seed: int) -> list[Figure]:
    """Plan with each belief, lift in each world, and compare with the belief in `kind`."""
    planners = {
        belief: SampledCnn(
            SampledCnnSettings(physics=belief, arm_error_m=ERROR_M, arm_error_rad=ERROR_RAD),
            MACHINE,
            FreeMotion(),
        )
        for belief in BELIEFS
    }
    rates: dict[tuple[Scenario, Scenario], list[float]] = {}
    nothing = dict.fromkeys(BELIEFS, 0)
    for i, (hull, solid) in enumerate(stones):
        picks = first_picks(solid, (seed, i), planners)
        for belief, T_map_gripper in picks.items():
            nothing[belief] += T_map_gripper is None
        for world in WORLDS:
            for belief in ("kind", world):
                share = lifted_share(world, hull, picks[belief], (seed, i))
                rates.setdefault((world, belief), []).append(share)
    for (world, belief), lifted in rates.items():
        low, high = interval(np.array(lifted))
        planned = len(lifted) - nothing[belief]
        fall = planned - sum(lifted)
        print(
            f"{kind} in {world}, rehearsed in {belief}: {100 * np.mean(lifted):.1f} % "
            f"[{100 * low:.0f}, {100 * high:.0f}] of {len(lifted)} stones lifted; "
            f"{planned} with a grasp, of which {fall:.1f} fall",
            flush=True,
        )
    return [_above_kind(kind, world, rates) for world in WORLDS]


def _above_kind(
    kind: str, world: Scenario, rates: dict[tuple[Scenario, Scenario], list[float]]
) -> Figure:
    more = 100 * (np.array(rates[world, world]) - np.array(rates[world, "kind"]))
    low, high = interval(more)
    words = f"{more.mean():.1f} [{low:.0f}, {high:.0f}]"
    what = f"{kind} in {world}: rehearsed in {world} above rehearsed in kind [points]"
    return held(what, float(more.mean()), NO_LESS, words)


def measured(stones: int, seed: int, scans: Path | None) -> list[Figure]:
    """Compare the beliefs on generated stones, and on the scans of a folder if one is given."""
    found = measure("generated", islice(generated(LabelSettings(), seed), stones), seed)
    if scans is not None:
        found += measure("scanned", islice(scanned(scans, seed), stones), seed)
    return found
