"""Lift a held stone by a little, and weigh whether the grip bears."""

from collections.abc import Generator
from itertools import combinations
from typing import Any

from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Seconds, Settings
from executive.events.stone import StoneNotLifted
from executive.geometry.pose import inverse
from executive.interfaces.mapping import Mapper
from executive.interfaces.monitoring import Monitor
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.alike_grasps import are_alike
from executive.leaf.claims import Part
from executive.leaf.context import Context
from executive.leaf.follow import follow
from executive.leaf.job import Job
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_surface, surroundings
from executive.leaf.way_up import risen_m, way_up
from executive.leaf.weighing import LEAST_SHARE, SURE, agree, hanging, least_kg
from executive.messages.ground_below import GroundBelow, ground_below
from executive.messages.hold import Hold
from executive.messages.stone import Stone
from executive.messages.weight import Weight

# A machine on its legs sinks under what it lifts, by up to half of the height. The first lift takes
# the load on, so the second one hardly sinks; a third is for a stone that the ground has borne
# until then. What holds back a machine that cannot sink is the stone, and it is not pulled again.
_LIFTS, _SUNK = 3, 0.25  # most lifts; share of the height that may be missing


class TrialLiftSettings(Settings):
    height: Meters = Field(
        0.2,
        gt=0,
        le=1,
        description="Height of the lift [m]: what is held at its edge has tilted by then, and "
        "still stands; a stone that falls from there stays on its side, as long as this is a small "
        "part of its width.",
    )
    wait: Seconds = Field(
        0.4,
        gt=0,
        le=10,
        description="Time for which the stone hangs there, and is weighed [s]; up to 2.5 s while "
        "the machine sways so far that the weight may be either side of the least one.",
    )
    borne: float = Field(
        LEAST_SHARE,
        ge=0,
        le=1,
        description="Least share of its mass by volume (2,700 kg/m³) that hangs in the jaws then, "
        "until the first stone of the site was weighed and placed; from then on two standard "
        "deviations less than that of the stones that were. Light stones need less: 0.5 for tuff "
        "of 2,000 kg/m³.",
    )


class TrialLift(Action[TrialLiftSettings]):
    """Lift a held stone off the ground by a little, and weigh it before it is raised.

    Beside `DetectSlip` in a `reactive_sequence`, as riggers do with any load. A grip that does not
    bear gives way at once: of 31 stones that were lost in six missions, 28 had moved by 5 cm in the
    jaws before the gripper was 0.15 m up. Many do not slide: they tilt about the tips, with an edge
    on the ground, and the jaws hardly close. Raised on, they turn over. So this fails while the
    ground carries a part of the stone: if less hangs in the jaws than a share of what its volume
    tells, as far as the stones of the site are known, or than it was weighed at before. Of 350
    simulated lifts of the true hull, to 0.2 m, none of those that would have held weighed less than
    0.67 of it, and 41 % of the others; with the 0.85 that is asked for after a few blocks 2 and
    68 %. A stone of which as much has hung by three grasps is a light one. Without a monitor that
    weighs, it only waits.

    A machine on its legs sinks under the load, by up to a decimetre: it lifts on until the gripper
    is as high in the map. An arm that is held back on its way up is told as such only if the whole
    stone hangs: jaws that close on a stone that widens towards the ground slide up on it, and press
    it down.
    """

    needs = (Robot, Mapper, MotionPlanner, ObjectDatabase, Monitor)
    claims = (Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO

    def __init__(self, settings: TrialLiftSettings, context: Context) -> None:
        super().__init__(settings, context)
        # T_object_gripper of the lifts with too little weight, and that weight, by stone.
        self._trials: dict[int, list[tuple[Float, Weight]]] = {}

    def run(self, hold: Hold) -> Steps[None]:
        """Lift, weigh and judge.

        Args:
            hold: Which stone is held, and how.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        lifted = succeeded()
        for _ in range(_LIFTS if self.context.machine().stance.is_free else 1):
            way_m = self.settings.height - risen_m(self.context, hold)
            if way_m <= _SUNK * self.settings.height or not lifted.success:
                break
            plan = yield from way_up(self.context, hold, way_m)
            if plan.trajectory is None:
                return succeeded(reason=f"not tried, no path up: {plan.reason}")
            lifted = yield from follow(self.context, plan.trajectory)
        return (yield from self._weighed(hold, lifted))

    def _weighed(self, hold: Hold, lifted: Outcome[None]) -> Steps[None]:
        """Wait, weigh the stone meanwhile, and judge it by that, and by how the arm got up."""
        objects = self.context.use(ObjectDatabase)
        stone = objects.stone(hold.stone_id)
        least = least_kg(stone, objects.stones(), self.settings.borne)
        weight = yield from hanging(self.context, self.settings.wait, least)
        up_m = risen_m(self.context, hold)
        if weight is None and not lifted.success:
            return lifted
        if weight is None:
            return succeeded(reason=f"it hangs {up_m:.2f} m up, and no monitor weighs it")
        if weight.mass_kg < least and not self._is_whole(hold, stone, weight):
            self.context.record(StoneNotLifted(hold.stone_id, up_m, weight.mass_kg, least))
            return failed(
                f"{_borne(weight, stone, up_m)}, and it weighs at least {_least(least, stone)}"
            )
        if not lifted.success:
            return lifted
        self.context.begin_carry()
        self.context.carry_over((yield from self._below(hold)))
        return succeeded(reason=f"it hangs {up_m:.2f} m up with {weight}")

    def _is_whole(self, hold: Hold, stone: Stone, weight: Weight) -> bool:
        """Return whether as much has hung in the jaws by three grasps: a light stone hangs free.

        The ground bears another part of a stone that is held elsewhere. Of a stone that has hung
        free before more is known than that.
        """
        is_lighter = weight.mass_kg < self.settings.borne * stone.mass_by_volume_kg
        if is_lighter or stone.weight is not None:
            return False
        T_object_gripper = inverse(stone.T_map_object) @ hold.T_map_gripper
        trials = self._trials.setdefault(stone.id, [])
        others = [one for one in trials if not are_alike(one[0], T_object_gripper)]
        trials.append((T_object_gripper, weight))
        return any(
            not are_alike(a[0], b[0]) and agree([a[1], b[1], weight])
            for a, b in combinations(others, 2)
        )

    def _below(self, hold: Hold) -> Generator[Job[Any], Any, GroundBelow]:
        """Return what is below the stone, wherever it is carried to."""
        context, held = self.context, held_surface(self.context, hold)
        T_base_map = inverse(context.state().T_map_base)
        cloud = yield from surroundings(context, hold.stone_id)
        T_base_gripper = T_base_map @ context.gripper()
        return (
            yield from context.job(ground_below, cloud.points, T_base_map, held, T_base_gripper)
        )


def _borne(weight: Weight, stone: Stone, up_m: float) -> str:
    """Say how the ground still carries a stone of which less hangs than it weighs."""
    if weight.mass_kg < -SURE * weight.std_kg:
        return (
            f"stone {stone.id} stands on the ground, and the jaws that close on it are pushed up "
            f"by the weight of {-weight.mass_kg:.0f} kg, {up_m:.2f} m above the grasp"
        )
    return (
        f"the ground still carries a part of stone {stone.id}: {up_m:.2f} m up, {weight} hang in "
        "the jaws"
    )


def _least(least_kg: float, stone: Stone) -> str:
    """Return the least mass of a stone in words, with its source."""
    by_volume = "by its volume; light stones need less `borne`"
    return f"{least_kg:.0f} kg ({by_volume if stone.weight is None else 'as weighed before'})"
