"""Plan how to set a held stone down."""

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.geometry.pose import transform
from executive.geometry.rotation import log_so3
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.placing import PlacementPlanner
from executive.leaf.action import Action, Steps
from executive.leaf.job import Job
from executive.leaf.leaning import leaning
from executive.leaf.lift_limit import LiftRule, too_heavy
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.resting import hung_over, moved, to_rest
from executive.leaf.surroundings import held_kg, held_surface, surroundings
from executive.leaf.turned import lower_by_m
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold
from executive.messages.placement import Placement, Slot
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.stone import Stone
from executive.messages.trajectory import JointTrajectory

_SAME_PLACE_M = 1.0  # about the radius of a stone, less than the distance of two that lie apart


class PlanPlacementSettings(Settings):
    leave: Meters = Field(
        1.0,
        ge=0,
        le=5,
        description="Straight lift before travelling, from where the jaws closed [m].",
    )
    arrive: Meters = Field(1.0, ge=0, le=5, description="Straight way down to the place [m].")
    above: Meters = Field(
        0.0,
        ge=0,
        le=1,
        description="Height above the place at which the way ends [m], for `LowerUntilDown`.",
    )
    as_it_hangs: bool = Field(
        False,
        description="Whether a stone for which no way leads to the pose of any slot is set down as "
        "it hangs over one, and tilts back as the ground meets it. Slots without a pose always "
        "allow it.",
    )
    lift_capacity: LiftRule = Field(
        "by_base",
        description="What limits the way: nothing more than at the grasp; or also the rated lift "
        "capacity by radius and side on the whole way to the slot (ISO 10567); by_base is the "
        "latter where the machine may tip.",
    )


@dataclass(frozen=True, slots=True)
class PlacementPlanned:
    """A placement, and a collision-free path to it.

    Attributes:
        placement: How the stone is set down, and on which slot.
        trajectory: The path there.
    """

    placement: Placement
    trajectory: JointTrajectory


class PlanPlacement(Action[PlanPlacementSettings]):
    """Find the first slot with a placement, and the first placement with a collision-free path.

    A stone that the closing jaws have tilted is turned back: it comes down on the side on which it
    lay. If no path leads there, because a jaw would meet the ground, it is set down as it hangs. A
    slot with the pose of a stone says itself how that is to rest; there the stone is set down as it
    hangs only with `as_it_hangs`.
    """

    needs = (PlacementPlanner, MotionPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(
        self, hold: Hold, free_slots: list[Slot], hang_is_known: bool | None = None
    ) -> Steps[PlacementPlanned]:
        """Plan for one slot after another.

        Args:
            hold: Which stone is held, and how.
            free_slots: Slots that are free, best first.
            hang_is_known: Whether the stone was seen as it hangs. If it was looked at and was not,
                it may have turned about the tips, and the motion ends higher by how much lower it
                may hang then.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        stone = self.context.use(ObjectDatabase).stone(hold.stone_id)
        placing = self.context.use(PlacementPlanner)
        cloud = yield from surroundings(self.context, hold.stone_id)
        T_map_base = self.context.state().T_map_base
        refused: dict[str, list[int]] = {}
        level = to_rest(stone, self.context.use(ObjectDatabase))
        weight = self.context.weight()
        mass_kg = stone.mass_kg if weight is None else weight.mass_kg
        slots = _own_first(free_slots, hold.T_map_gripper[:3, 3])
        for slot, T_map_map in self._attempts(slots, stone, hold, level):
            placements = yield from self.context.job(
                placing.plan,
                moved(stone, T_map_map),
                slot,
                T_map_map @ hold.T_map_gripper,
                cloud,
                T_map_base,
            )
            if not placements:
                refused.setdefault("no placement is free and in reach", []).append(slot.id)
            for placement in placements:
                above_m = self._above_m(placement, hold, hang_is_known)
                plan = yield from self._path_to(placement, above_m, hold, cloud, mass_kg)
                refusal = too_heavy(self.context, plan, mass_kg, self.settings.lift_capacity)
                if plan.trajectory is not None and not refusal:
                    self.context.show("path", plan)
                    asked = next(one for one in free_slots if one.id == slot.id)
                    found = PlacementPlanned(_in_slot(placement, asked), plan.trajectory)
                    told = ", as it hangs" if slot is not asked else _turned(T_map_map)
                    return succeeded(found, f"slot {slot.id}{told}")
                refused.setdefault(refusal or plan.reason, []).append(slot.id)
        return failed(f"no path to any of {len(free_slots)} slots: {_causes(refused)}")

    def _attempts(
        self, slots: Sequence[Slot], stone: Stone, hold: Hold, level: Float
    ) -> Iterator[tuple[Slot, Float]]:
        """Yield each slot with the motions by which the stone may be turned for it, best first."""
        is_level = np.array_equal(level, np.eye(4))
        for slot in slots:
            if slot.T_map_object is None and not is_level:
                yield slot, level
            yield slot, np.eye(4)
        if is_level or not self.settings.as_it_hangs:
            return
        centre = self.context.machine().gripper.grasp_centre
        centre_map = transform(hold.T_map_gripper, centre[None])[0]
        for slot in slots:
            if slot.T_map_object is not None:
                hung = hung_over(stone, level, slot.T_map_object, centre_map)
                if hung is not None:
                    yield replace(slot, T_map_object=hung), np.eye(4)

    def _above_m(self, placement: Placement, hold: Hold, hang_is_known: bool | None) -> float:
        """Return how far above the placement the motion ends [m]."""
        if hang_is_known is not False:
            return self.settings.above
        surface, T = held_surface(self.context, hold), placement.T_map_gripper
        lower_m = lower_by_m(self.context.machine(), hold.jaw_rad, surface, T)
        return self.settings.above + lower_m

    def _path_to(
        self, placement: Placement, above_m: float, hold: Hold, cloud: Cloud, mass_kg: float
    ) -> Generator[Job[Any], Any, MotionPlan]:
        risen_m = float(self.context.gripper()[2, 3] - hold.T_map_gripper[2, 3])
        goal = placement.T_map_gripper.copy()
        goal[2, 3] += above_m
        T_map_base = yield from leaning(self.context, goal, mass_kg)
        request = MoveRequest(
            start=self.context.arm(),
            T_map_gripper=goal,
            T_map_base=T_map_base,
            leave_m=min(max(self.settings.leave - risen_m, 0.0), self.settings.leave),
            arrive_m=self.settings.arrive,
            obstacles=cloud,
            held_gripper=held_surface(self.context, hold),
            jaw_rad=hold.jaw_rad,
            held_kg=held_kg(self.context),
        )
        return (yield from self.context.job(self.context.use(MotionPlanner).move, request))


def _own_first(slots: Sequence[Slot], taken_map: Float) -> list[Slot]:
    """Return slots in the order in which they are tried for a stone that was taken from a place.

    First comes the one that is meant for it, then those for any stone, then those for others.
    """

    def rank(slot: Slot) -> int:
        if slot.meant_for_map is None:
            return 1
        away_m = np.linalg.norm((slot.meant_for_map - taken_map)[:2])
        return 0 if away_m < _SAME_PLACE_M else 2

    return sorted(slots, key=rank)


def _causes(refused: Mapping[str, Sequence[int]]) -> str:
    """Return each reason once, after the slots that it is true of."""
    parts = []
    for reason, slots in refused.items():
        numbers = list(dict.fromkeys(slots))
        named = f"slot{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"
        parts.append(f"{named}: {reason}")
    return "; ".join(parts)


def _in_slot(placement: Placement, asked: Slot) -> Placement:
    """Return a placement whose stone is to rest as its slot asks for, however it hangs over it."""
    if asked.T_map_object is None:
        return placement
    return replace(placement, slot=asked, T_map_object=asked.T_map_object)


def _turned(T_map_map: Float) -> str:
    turn_rad = float(np.linalg.norm(log_so3(T_map_map[:3, :3])))
    return f", turned back by {np.degrees(turn_rad):.1f}°" if turn_rad else ""
