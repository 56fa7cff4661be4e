"""Choose the next stone of a structure, and the pose in which it is to rest there."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.events.site import BuildingEnded, BuildingPlanned, PlaceNotFound
from executive.geometry.pose import inverse, transform
from executive.interfaces.building import StructurePlanner
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.bare_ground import bare_ground
from executive.leaf.body_within import body_within
from executive.leaf.failed_releases import failed_releases
from executive.leaf.filled_place import is_filled
from executive.leaf.job import Job
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.resting import moved, to_rest
from executive.leaf.sightings import sightings
from executive.leaf.slots_found import tell_slots
from executive.leaf.solid_stones import solid_stones
from executive.leaf.surroundings import map_cloud, unexplained
from executive.machine.jaw_clearance import released_jaws
from executive.messages.building import AsBuilt, BuildPlan, BuildTarget, StandingStone
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.height_grid import HeightGrid
from executive.messages.hold import Hold
from executive.messages.placement import Slot
from executive.messages.segment import Segmentation
from executive.messages.stone import Stone, StoneState
from executive.messages.structure import Structure

_ROLLED = 1.5  # lengths of a lost stone in which it is sought: it has rolled by one
_SAME_M = 0.1  # of the middles of what is seen of one body, from around two places
_LIE = (StoneState.ON_GROUND, StoneState.SET_ASIDE)


class PlanBuildingSettings(Settings):
    room: Meters = Field(
        0.05, ge=0, le=0.5, description="By how much each side of the next stone is taken to be "
        "farther out than it was seen: for its unseen parts and for errors of placing [m]."
    )  # fmt: skip
    seen_ground: float = Field(
        0.5, ge=0, le=1, description="Least share of the ground below the structure that the map "
        "must show."
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class BuildingStep:
    """The next stone and its places.

    Attributes:
        stone: Id of the stone.
        free_slots: Poses in which it may rest, best first, each as a slot.
    """

    stone: int
    free_slots: list[Slot]


@dataclass(frozen=True, slots=True)
class BuildingOver:
    """Why no stone follows.

    Attributes:
        ending: `complete`, `nothing_fits`, `no_stones`, `all_too_heavy`, `all_unsuitable`,
            `out_of_time`, or `stale_map`.
    """

    ending: str


class PlanBuilding(Action[PlanBuildingSettings]):
    """Ask the building planner for the next stone, on the structure as it stands.

    The stones that stand are those that are placed, at their poses of the database: where the last
    look saw them, not where they were planned. A stone that was released and not seen since makes
    the map stale: nothing is planned on it. A stone that lies within the structure without having
    been placed, because it fell or rolled there, is adopted as built; so is one that is not
    recognised where it was last, if the map shows a body there. The next stone is one that lies on
    the ground elsewhere, or the one that is asked for. That may be in the jaws: places are sought
    for it in the attitude in which it lay, by turns about the vertical.
    """

    needs = (StructurePlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(
        self,
        structure: Structure,
        segmentation: Segmentation,
        for_stone: int | None = None,
        held_by: list[Grasp] | None = None,
        in_jaws: Hold | None = None,
        least_score: float | None = None,
    ) -> Steps[BuildingStep | BuildingOver]:
        """Plan one stone.

        Args:
            structure: What is to be built.
            segmentation: The site before the first stone was moved; its ground is used.
            for_stone: Id of the only stone that may be chosen, on the ground or in the jaws; by
                default any on the ground.
            held_by: Grasps of that stone: beside its place there has to be room for the jaws of
                one of them.
            in_jaws: How that stone is held, in place of grasps.
            least_score: Grasps with a lower score do not count; by default all do.
        """
        stones = self.context.use(ObjectDatabase).stones()
        standing = [one for one in stones if one.state is StoneState.PLACED]
        ground, seen = bare_ground(segmentation.ground.points, structure)
        if stale := self._stale(standing, seen):
            return self._over(structure, "stale_map", stale, standing)
        objects, points = self.context.use(ObjectDatabase), segmentation.ground.points
        solid_of = solid_stones(stones, points, objects)
        within = [one for one in stones if one.id != for_stone
                  and _is_within(structure, solid_of[one.id])]  # fmt: skip
        adopted = yield from self._adopted(within)
        bodies = yield from self._bodies(structure, ground, stones, adopted)
        standing += adopted + [one for one in stones if one.id in bodies]
        free = _free([one for one in stones if one not in adopted], for_stone, objects)
        if for_stone is not None and not free:
            return _cannot(for_stone, stones)
        as_built = {one.id: solid_of[one.id] for one in standing} | bodies
        solids = solid_stones(free, points, objects, self.settings.room)
        if for_stone is not None:
            held = _likely(held_by or (), least_score) if in_jaws is None else [in_jaws]
            solids[for_stone] = self._with_jaws(free[0], solids[for_stone], held)
        own = {n: one for n, one in as_built.items() if n not in bodies}
        lost = failed_releases(stones, own, solid_of, objects)
        beside = [one for one in stones if one.state in _LIE and one not in standing
                  and one.id != for_stone]  # fmt: skip
        around = tuple(solid_of[one.id] for one in beside)
        plan = yield from self.context.job(
            self.context.use(StructurePlanner).propose,
            AsBuilt(structure, ground, tuple(as_built.values()), lost, around),
            tuple(one.stone for one in solids.values()),
            self.context.rng(),
        )
        if plan.targets:
            return self._next(structure, plan, free, solids, standing)
        if for_stone is not None:
            return self._no_place(structure, free[0], plan)
        told = plan.detail or "no place holds any stone"
        return self._over(structure, str(plan.reason), told, standing, plan)

    def _with_jaws(
        self, stone: Stone, lying: StandingStone, held: Sequence[Grasp | Hold]
    ) -> StandingStone:
        """Return the solid of a stone with the jaws that let it go, of each way to hold it.

        The gripper holds the stone as the database has it, and moves with it to where it lies.
        """
        gripper, jaws = self.context.machine().gripper, []
        known = self.context.use(ObjectDatabase).stone(stone.id)
        T_lying_known = stone.T_map_object @ inverse(known.T_map_object)
        for T_map_gripper in (T_lying_known @ one.T_map_gripper for one in held):
            surface = transform(inverse(T_map_gripper), stone.points_map)
            points = released_jaws(gripper, surface, T_map_gripper[2, :3])
            jaws.append(transform(inverse(lying.T_map_stone) @ T_map_gripper, points))
        return StandingStone(replace(lying.stone, jaws=tuple(jaws)), lying.T_map_stone)

    def _adopted(self, within: Sequence[Stone]) -> Generator[Job[Cloud], Cloud, list[Stone]]:
        """Return the stones within the structure that are part of it without having been placed.

        One that was placed, and that a later look did not recognise, is placed again: it is not
        looked for elsewhere, where its model would be replaced by a piece of its neighbours.
        """
        objects = self.context.use(ObjectDatabase)
        lost = [one for one in within if one.state is StoneState.LOST]
        shown: list[Stone] = []
        if lost:
            cloud = yield from map_cloud(self.context)
            shown = [one for one in lost if is_filled(cloud, one)]
        for one in shown:
            if sightings(objects, one.id):
                objects.set_state(one.id, StoneState.PLACED, self.context.now_s())
        return shown + [one for one in within if one.state in _LIE]

    def _bodies(
        self,
        structure: Structure,
        ground: HeightGrid,
        stones: Sequence[Stone],
        adopted: Sequence[Stone],
    ) -> Generator[Job[Cloud], Cloud, dict[int, StandingStone]]:
        """Return the bodies that the map shows where stones were lost, one for each by its id.

        Nobody recognises such a stone, and something lies there: nothing can be set down in it.
        """
        found: dict[int, StandingStone] = {}
        lost = [one for one in stones if one.state is StoneState.LOST and one not in adopted]
        for one in lost:
            around = yield from unexplained(self.context, one.id, _ROLLED * one.length_m)
            body = body_within(around.points, one, structure, ground)
            if body is not None and not any(_is_same(body, other) for other in found.values()):
                found[one.id] = body
        return found

    def _stale(self, standing: Sequence[Stone], seen: float) -> str:
        """Return why nothing may be planned on what is known; empty if it may."""
        if seen < self.settings.seen_ground:
            return f"the map shows {seen:.0%} of the ground below the structure: scan it first"
        objects = self.context.use(ObjectDatabase)
        unseen = [str(one.id) for one in standing if not sightings(objects, one.id)]
        if unseen:
            return f"stone {', '.join(unseen)} was not seen since its release: scan it first"
        return ""

    def _over(
        self,
        structure: Structure,
        reason: str,
        detail: str,
        standing: Sequence[Stone],
        plan: BuildPlan | None = None,
    ) -> Outcome[BuildingOver]:
        ids = tuple(one.id for one in standing)
        refused = {} if plan is None else dict(plan.refused)
        by_stone = {} if plan is None else dict(plan.by_stone)
        ended = BuildingEnded(structure.name, reason, detail, ids, refused, by_stone, structure)
        self.context.record(ended)
        return failed(f"{reason}: {detail}", BuildingOver(reason))

    def _no_place(
        self, structure: Structure, stone: Stone, plan: BuildPlan
    ) -> Outcome[BuildingStep | BuildingOver]:
        """Return that one stone has no place, and tell it."""
        is_held, refused = stone.state is StoneState.HELD, dict(plan.refused)
        told = PlaceNotFound(structure.name, stone.id, is_held, str(plan.reason), refused)
        self.context.record(told)
        return failed(f"stone {stone.id} has no other place: {_why(plan)}", is_final=True)

    def _next(
        self,
        structure: Structure,
        plan: BuildPlan,
        free: Sequence[Stone],
        solids: Mapping[int, StandingStone],
        standing: Sequence[Stone],
    ) -> Outcome[BuildingStep]:
        """Return the stone of the best target, and its targets as slots."""
        best = plan.targets[0]
        stone = next(one for one in free if str(one.id) == best.stone)
        lying = solids[stone.id]
        targets = [one for one in plan.targets if one.stone == best.stone]
        slots = [_slot(n, one, lying, stone) for n, one in enumerate(targets, 1)]
        self.context.record(
            BuildingPlanned(
                structure=structure.name,
                stone=stone.id,
                T_map_object=np.asarray(slots[0].T_map_object),
                standing=tuple(one.id for one in standing),
                worst_m=best.worst_m,
                score=best.score,
                terms=dict(best.terms),
                refused=dict(plan.refused),
            )
        )
        told = tell_slots(self.context, slots)
        return succeeded(BuildingStep(stone.id, list(told)), f"stone {stone.id}")


def _why(plan: BuildPlan) -> str:
    """Return why there is no target, with the numbers of places that were passed over."""
    told = ", ".join(f"{n} × {reason}" for reason, n in plan.refused.items())
    return f"{plan.reason}; {told}" if told else str(plan.reason)


def _cannot(for_stone: int, stones: Sequence[Stone]) -> Outcome[BuildingStep | BuildingOver]:
    state = next((one.state.value for one in stones if one.id == for_stone), "unknown")
    told = f"stone {for_stone} cannot be placed: it is {state}, neither held nor lying"
    return failed(told, is_final=True)


def _free(stones: Sequence[Stone], for_stone: int | None, objects: ObjectDatabase) -> list[Stone]:
    """Return the stones that may be chosen, each as it would rest: held ones tilted back to it."""
    if for_stone is None:
        return [one for one in stones if one.state is StoneState.ON_GROUND]
    asked = [one for one in stones if one.id == for_stone]
    lying = [one for one in asked if one.state is StoneState.ON_GROUND]
    held = [one for one in asked if one.state is StoneState.HELD]
    return lying + [moved(one, to_rest(one, objects)) for one in held]


def _likely(grasps: Sequence[Grasp], least_score: float | None) -> list[Grasp]:
    return [one for one in grasps if least_score is None or one.score >= least_score]


def _is_within(structure: Structure, solid: StandingStone) -> bool:
    """Return whether the middle of a stone is above the foot of a structure."""
    return bool(structure.depth_m(solid.T_map_stone[None, :2, 3], np.zeros(1))[0] >= 0.0)


def _is_same(body: StandingStone, other: StandingStone) -> bool:
    """Return whether two bodies, found for two stones, are one."""
    return bool(np.allclose(body.T_map_stone[:3, 3], other.T_map_stone[:3, 3], atol=_SAME_M))


def _slot(number: int, target: BuildTarget, lying: StandingStone, stone: Stone) -> Slot:
    """Return a target as a slot below the lowest point of the stone at rest."""
    T_map_map = target.T_map_settled @ inverse(lying.T_map_stone)
    at_rest = StandingStone(lying.stone, target.T_map_settled).vertices_map()
    place = np.array([*target.T_map_settled[:2, 3], at_rest[:, 2].min()])
    return Slot(number, place, None, 0.0, T_map_map @ stone.T_map_object)
