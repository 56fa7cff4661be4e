"""The loop of a trial: plan a stone, let it go with noise, measure, and plan the next."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from executive.geometry.rotation import angle_between
from executive.interfaces.building import MayGoOn, StructurePlanner
from executive.interfaces.trial_site import TrialSite
from executive.messages.building import AsBuilt, BuildPlan, StandingStone
from executive.messages.solid_stone import SolidStone

_RIGHT_M, _RIGHT_RAD = 0.10, math.radians(10.0)  # a stone that settles within is where it should be


@dataclass(frozen=True, slots=True, eq=False)
class PlacedStone:
    """One stone of a trial: what was planned, and what came of it."""

    stone: str
    plan: BuildPlan
    built: AsBuilt
    error_m: float
    error_rad: float
    moved_m: float
    planning_cpu_s: float

    @property
    def is_right(self) -> bool:
        """Return whether it settled within 10 cm and 10° of its plan."""
        return self.error_m <= _RIGHT_M and self.error_rad <= _RIGHT_RAD


@dataclass(slots=True, eq=False)
class Trial:
    """A structure as it grows.

    Attributes:
        built: As it stands.
        placed: What was done so far.
        reason: Why it ended; empty while it goes on.
        last: The plan that ended it, if there was one.
    """

    built: AsBuilt
    placed: list[PlacedStone] = field(default_factory=list)
    reason: str = ""
    last: BuildPlan | None = None


@dataclass(frozen=True, slots=True)
class TrialRules:
    """Noise of releases [m] and [rad], the most stones, and processor time for each plan [s]."""

    noise: tuple[float, float]
    most: int
    budget_s: float | None = None


def build(
    start: AsBuilt,
    inventory: Sequence[SolidStone],
    planner: StructurePlanner,
    site: TrialSite,
    rules: TrialRules,
    rng: np.random.Generator,
    watch: Callable[[PlacedStone], None] = lambda placed: None,
) -> Trial:
    """Build until the planner has no target or the most stones stand."""
    trial = Trial(start)
    left = {stone.name: stone for stone in inventory}
    while len(trial.placed) < rules.most:
        begun = time.process_time()
        plan = planner.propose(trial.built, tuple(left.values()), rng, _until(rules.budget_s))
        spent_s = time.process_time() - begun
        if not plan.targets:
            trial.reason, trial.last = str(plan.reason), plan
            return trial
        stone = left.pop(plan.targets[0].stone)
        placed = _place(trial.built, stone, plan, site, rules, rng, spent_s)
        trial.built = placed.built
        trial.placed.append(placed)
        watch(placed)
    trial.reason = "most_stones"
    return trial


def _place(
    built: AsBuilt,
    stone: SolidStone,
    plan: BuildPlan,
    site: TrialSite,
    rules: TrialRules,
    rng: np.random.Generator,
    spent_s: float,
) -> PlacedStone:
    target = plan.targets[0]
    settled = site.place(built, stone, target.T_map_stone, rules.noise, rng)
    stones = [one.stone for one in built.standing] + [stone]
    standing = [StandingStone(s, T) for s, T in zip(stones, settled.poses, strict=True)]
    T, wanted = settled.poses[-1], target.T_map_settled
    return PlacedStone(
        stone.name,
        plan,
        built.with_standing(*standing),
        float(np.linalg.norm(T[:3, 3] - wanted[:3, 3])),
        angle_between(T[:3, :3], wanted[:3, :3]),
        settled.moved_m,
        spent_s,
    )


def _until(budget_s: float | None) -> MayGoOn:
    if budget_s is None:
        return lambda: True
    end = time.process_time() + budget_s
    return lambda: time.process_time() < end


def answer_of(trial: Trial) -> dict[str, Any]:
    """Return a trial as plain values, SI units in the names."""
    last = trial.last
    return {
        "structure": trial.built.structure.name,
        "ended": trial.reason,
        "detail": last.detail if last else "",
        "refused_at_the_end": dict(last.refused) if last else {},
        "placed": [_stone_answer(one) for one in trial.placed],
        "right": sum(one.is_right for one in trial.placed),
        "standing": [
            {"stone": one.stone.name, "T_map_stone": one.T_map_stone.tolist()}
            for one in trial.built.standing
        ],
    }


def _stone_answer(one: PlacedStone) -> dict[str, Any]:
    target = one.plan.targets[0]
    return {
        "stone": one.stone,
        "T_map_stone": target.T_map_stone.tolist(),
        "T_map_settled": target.T_map_settled.tolist(),
        "worst_m": target.worst_m,
        "worst_rad": target.worst_rad,
        "score": target.score,
        "terms": dict(target.terms),
        "refused": dict(one.plan.refused),
        "error_m": one.error_m,
        "error_rad": one.error_rad,
        "moved_others_m": one.moved_m,
        "planning_cpu_s": one.planning_cpu_s,
        "is_right": one.is_right,
    }
