"""The plan of all sampling planners: pool, order, feasibility, lift (Mascaro 2020, Sec. 5)."""

from abc import abstractmethod
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from executive_plugins.grasping.feasibility.approach_path import ApproachPath
from executive_plugins.grasping.feasibility.arm_reach import ArmReach
from executive_plugins.grasping.feasibility.fcl_check import FclCheck
from executive_plugins.grasping.load import Load, load_of
from executive_plugins.grasping.rehearsal import HELD, Rehearsed, rehearsal_of
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.sampling.pool import Pool, Sampler
from executive_plugins.grasping.sampling.ranking import (
    SPREAD_M,
    SPREAD_RAD,
    Costs,
    ranked_rounds,
    spread,
)
from executive_plugins.grasping.settings import SampledPlannerSettings
from executive_plugins.grasping.simulated_lift import SimulatedLift
from executive_plugins.physics.belief import belief_of

from executive.arrays import Float, checked
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.stone import Stone

_ROOM_IN_CLOUD_M = 0.01  # a point deeper than this in the open gripper is a collision
_FEW_POINTS = 20  # with fewer points the shape of a stone is unknown
# Stop simulating once this many grasps are firm: one for each attempt of a mission that tries a
# stone three times, and one whose path is blocked.
_ENOUGH = 4


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """The order in which the M grasps of a pool are tried.

    Attributes:
        indices: Best first, consumed lazily.
        worth: First term of the score of each grasp, shape (M,).
        costs: Further costs by name, each of shape (M,).
        is_telling: Whether the worth predicts the success; else it says nothing before a lift.
        least_score: Score below which a grasp is refused.
    """

    indices: Iterable[int]
    worth: Float
    costs: Costs
    is_telling: bool
    least_score: float = -np.inf


@dataclass(slots=True, eq=False)
class _Lifted:
    """A grasp that is proposed: its row in the pool, its worth, and what came of its lifts."""

    row: int
    grasp: Grasp
    worth: float
    seen: Rehearsed | None


class _Refused(Counter[str]):
    """Numbers of refused hypotheses by reason, and the figures behind the first heavy one."""

    detail = ""


class SampledPlanner(GraspPlanner):
    """Samples grasps of a stone, orders them, and returns the first that are feasible.

    Subclasses implement the order in `ordered`.
    """

    latency_s: ClassVar[dict[str, float]] = {"plan": 1.2}  # on one core at p95, rounded up
    is_stateless: ClassVar[bool] = True

    def __init__(
        self, settings: SampledPlannerSettings, machine: Machine, motion: MotionPlanner
    ) -> None:
        self._settings: SampledPlannerSettings = settings
        self._machine = machine
        self._arm = ArmReach(machine, motion)
        self._sampler = Sampler(settings, machine.gripper)
        self._rehearsal = rehearsal_of(
            belief_of(settings.physics, machine.gripper, settings.steel_friction),
            settings.arm_error_m,
            settings.arm_error_rad,
        )

    def start(self) -> None:
        """Tabulate the gripper and compile the loops that plans need."""
        self._sampler.prepare()

    @abstractmethod
    def ordered(self, scene: PlanningCloud, pool: Pool) -> Order:
        """Return the order in which the grasps of a pool are tried."""

    def plan(
        self, target: Stone, cloud: Cloud, T_map_base: Float, rng: np.random.Generator
    ) -> GraspPlan:
        """Plan grasps, best first; the plan is empty, with reasons, if the stone cannot be held.

        Raises:
            DataError: If the cloud is not in the map.
        """
        if cloud.frame != "map":
            raise DataError(
                f"the grasp planner needs a cloud in the frame 'map', got '{cloud.frame}'"
            )
        if len(target.points_map) < _FEW_POINTS:
            return GraspPlan((), {"too_few_points": 1})
        scene, *more = self._sampler.scenes(target.points_map, cloud.points, rng)
        load, limit_kg = load_of(target, scene, self._settings), self._machine.payload_kg
        if load.least_kg > limit_kg:
            detail = f"{load.words}, and the gripper lifts {limit_kg:.0f} kg"
            return GraspPlan((), {"too_heavy": 1}, is_final=True, detail=detail)
        if scene.least_width_m > self._machine.gripper.max_opening_m:
            detail = (
                f"{scene.least_width_m:.2f} m wide, and the jaws open to "
                f"{self._machine.gripper.max_opening_m:.2f} m"
            )
            return GraspPlan((), {"wider_than_opening": 1}, detail=detail)
        held_before = target.T_map_object @ target.T_object_gripper
        T_map_base, refused = checked("T_map_base", T_map_base, 4, 4), _Refused()
        grasps: list[Grasp] = []
        for one in (scene, *more):
            pool = self._sampler.pool(one, rng, held_before)
            refused.update(pool.refused)
            grasps += self._chosen(one, pool, T_map_base, load, refused) if len(pool) else ()
        grasps.sort(key=lambda grasp: -grasp.score)  # stable: equal scores keep their order
        counts = {reason: n for reason, n in sorted(refused.items()) if n}
        return GraspPlan(tuple(grasps), counts, detail=refused.detail)

    def paper_order(self, pool: Pool) -> Iterator[int]:
        """Yield the indices of a pool in the order of the paper's stages (Sec. 5.4).

        Grasps that do not pass the stages go through them again after the others.
        """
        s = self._settings
        stages = [("align_rad", s.keep_aligned), ("enclose_m", s.keep_enclosing)]
        return (
            int(i) for passed in ranked_rounds(pool.costs, stages, "distance_m") for i in passed
        )

    def _chosen(
        self,
        scene: PlanningCloud,
        pool: Pool,
        T_map_base: Float,
        load: Load,
        refused: _Refused,
    ) -> tuple[Grasp, ...]:
        """Simulate lifts of the first feasible grasps, and rank them by worth less slip.

        Each grasp that is returned has been lifted, as the later ones are for attempts after a
        failure. Where the worth is telling, simulation stops once there are enough firm grasps and
        no other one can become the best; the best is lifted again to confirm it. Grasps that have
        held the stone before come first, and each time counts as lifts that were made.
        """
        s, order, lifts = self._settings, self.ordered(scene, pool), self._lifts(scene, load)
        found: list[_Lifted] = []
        firm, best = 0, -np.inf
        indices = _known_first(pool, order.indices)
        attainable = self._attainable(scene, pool, indices, T_map_base, load, refused)
        for tried, (i, T_map_gripper) in enumerate(attainable, start=1):
            worth, rehearsal = float(order.worth[i]), self._rehearsal
            if order.is_telling and firm >= _ENOUGH and best >= rehearsal.highest(worth):
                break
            predicted = worth if order.is_telling else None
            seen = self._rehearsed(lifts, pool, i, predicted, best)
            known = None if seen is None else _with_past(seen, pool, i)
            score = worth if known is None else rehearsal.score(worth, order.is_telling, known)
            firm += known is not None and rehearsal.is_firm(known)
            if known is not None and rehearsal.slips(known, s.max_slip_m):
                refused["slips"] += 1
            elif score < order.least_score:
                refused["unlikely"] += 1
            else:
                best = max(best, score)
                costs = _costs_at(i, pool.costs, order.costs) | _costs_of(seen)
                opening_m = self._machine.gripper.max_opening_m
                rate = None if known is None else rehearsal.rate_of(score)
                grasp = Grasp(T_map_gripper, opening_m, score, costs, rate)
                found.append(_Lifted(i, grasp, worth, seen))
            if tried == (s.rehearsed or s.max_grasps) or (not order.is_telling and firm == _ENOUGH):
                break
        if order.is_telling:
            self._confirm(found, lifts, pool)
        likely = [one.grasp for one in found if one.grasp.score >= order.least_score]
        refused["unlikely"] += len(found) - len(likely)
        likely.sort(key=lambda grasp: -grasp.score)  # stable: equal scores keep their order
        return tuple(likely[: s.max_grasps])

    def _lifts(self, scene: PlanningCloud, load: Load) -> dict[float, SimulatedLift]:
        """Return the simulated lifts of a stone, by how far its unseen foot is drawn in."""
        gripper, normal = self._machine.gripper, scene.ground.normal
        return {
            foot: SimulatedLift(gripper, scene.body(foot), normal, load.mass_kg)
            for foot in self._rehearsal.feet
        }

    def _confirm(
        self, found: list[_Lifted], lifts: Mapping[float, SimulatedLift], pool: Pool
    ) -> None:
        """Lift the best grasp again, until the best one was."""
        confirmed: set[_Lifted] = set()
        while found:
            best = max(found, key=lambda one: one.grasp.score)
            if best.seen is None or best in confirmed:
                return
            confirmed.add(best)
            i, rehearsal = best.row, self._rehearsal
            T, jaw_rad = pose(pool.R[i], pool.position[i]), float(pool.jaw_rad[i])
            depth_m = -float(pool.costs["shallow_m"][i])
            best.seen = rehearsal.confirmed(lifts, T, jaw_rad, depth_m, best.seen)
            known = _with_past(best.seen, pool, i)
            score = rehearsal.score(best.worth, True, known)
            costs = {**best.grasp.costs, **_costs_of(best.seen)}
            rate = rehearsal.rate_of(score)
            best.grasp = replace(best.grasp, score=score, costs=costs, hold_rate=rate)

    def _rehearsed(
        self,
        lifts: Mapping[float, SimulatedLift],
        pool: Pool,
        i: int,
        predicted: float | None,
        to_beat: float,
    ) -> Rehearsed | None:
        """Return what came of the simulated lifts of a grasp; None if none are to be made."""
        if not self._settings.rehearsed:
            return None
        T_plan_gripper = pose(pool.R[i], pool.position[i])
        return self._rehearsal.lift(
            lifts, T_plan_gripper, float(pool.jaw_rad[i]), predicted, to_beat
        )

    def _attainable(
        self,
        scene: PlanningCloud,
        pool: Pool,
        order: Iterable[int],
        T_map_base: Float,
        load: Load,
        refused: _Refused,
    ) -> Iterator[tuple[int, Float]]:
        """Yield index and T_map_gripper of the feasible grasps, in the given order.

        Feasible means: in reach of the arm, with a free approach path.
        """
        gripper, scale, up = self._machine.gripper, self._settings.scale, scene.ground.normal
        approach_m, room_m = scale * self._settings.approach_m, scale * _ROOM_IN_CLOUD_M
        approach, fcl_check = ApproachPath(gripper, scale), FclCheck(gripper, room_m)
        for i in spread(order, pool.R, pool.position, scale * SPREAD_M, SPREAD_RAD):
            T_plan_gripper = pose(pool.R[i], pool.position[i])
            T_map_gripper = self._arm.reached(
                scene.T_map_plan @ T_plan_gripper, T_map_base, approach_m
            )
            if T_map_gripper is None:
                refused["out_of_reach"] += 1
            elif not self._arm.holds(T_map_gripper, T_map_base, load.least_kg):
                refused["too_heavy_at_radius"] += 1
            elif self._machine.stance.limits_by_tipping(self._settings.lift_capacity) and (
                told := self._arm.refusal(T_map_gripper, T_map_base, load.least_kg)
            ):
                refused["beyond_lift_capacity"] += 1
                refused.detail = refused.detail or told
            elif not approach.is_free(scene.points, T_plan_gripper, up, approach_m, room_m):
                refused["approach_blocked"] += 1
            elif not fcl_check.is_free(scene.points, T_plan_gripper):
                refused["gripper_in_cloud"] += 1
            else:
                yield i, T_map_gripper


def _known_first(pool: Pool, order: Iterable[int]) -> Iterator[int]:
    """Yield the grasps that have held the stone, then the others in their order."""
    yield from (int(i) for i in np.flatnonzero(pool.times_held))
    yield from (i for i in order if not pool.times_held[i])


def _with_past(seen: Rehearsed, pool: Pool, i: int) -> Rehearsed:
    """Return what came of the lifts of a grasp, with the times that it held the stone."""
    times = int(pool.times_held[i])
    return seen.joined(HELD, times) if times else seen


def _costs_at(i: int, *costs: Mapping[str, Float]) -> dict[str, float]:
    """Return the costs of one grasp of a pool, by name."""
    return {name: float(values[i]) for one in costs for name, values in one.items()}


def _costs_of(seen: Rehearsed | None) -> dict[str, float]:
    """Return the costs that lifts of a grasp add."""
    return {} if seen is None else {"slip_m": seen.slip_m, "push_m": seen.push_m}
