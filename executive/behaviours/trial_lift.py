"""Lift a held stone by a little, and weigh whether the grip bears."""

from collections.abc import Generator
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
from executive.leaf.calm import calm
from executive.leaf.claims import Part
from executive.leaf.follow import follow
from executive.leaf.job import Job
from executive.leaf.load_moment import LoadMoment
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_surface, surroundings
from executive.leaf.way_back import way_back
from executive.leaf.way_up import risen_m, way_up
from executive.leaf.weighing import (
    LEAST_SHARE,
    SURE,
    Asked,
    are_equal,
    asked_of,
    hanging,
    hanging_precisely,
)
from executive.machine.stance import LEFT
from executive.messages.ground_below import GroundBelow, ground_below
from executive.messages.hold import Hold
from executive.messages.stone import Stone
from executive.messages.weight import Weight

# A machine on its legs sinks under what it lifts, by up to half of the height. Where that is much,
# the first lift takes the load on, so the second one hardly sinks; a third is for a stone that the
# ground has borne until then. What holds back a machine that cannot sink is the stone, and it is
# not pulled again.
_LIFTS, _SUNK = 3, 0.25  # most lifts; share of the height that may be missing
_HIGHER = 0.5  # share of the height by which a stone is raised that is weighed once more
# A stone weighs no more than this share of what it was weighed at before: of 47 that were weighed
# again the largest was 1.22. Of two that lay against each other 1.57 hung in the jaws.
_MOST = 1.25


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
        description="Least share of its mass by volume (2,700 kg/m³) that hangs in the jaws then. "
        "Light stones need less: 0.5 for tuff of 2,000 kg/m³.",
    )


class TrialLift(Action[TrialLiftSettings]):
    """Lift a held stone off the ground by a little, and weigh it before it is raised.

    Beside `DetectSlip` in a `reactive_sequence`, as riggers do with any load. A grip that does not
    bear gives way at once: of 31 stones that were lost in six missions, 28 had moved by 5 cm in the
    jaws before the gripper was 0.15 m up. Many do not slide: they tilt about the tips, with an edge
    on the ground, and the jaws hardly close. Raised on, they turn over. So this fails while the
    ground carries a part of the stone. That is so if less hangs in the jaws than it was weighed at
    before, or than a share of what its volume tells: of 350 simulated lifts of the true hull, to
    0.2 m, none of those that would have held weighed less than 0.67 of it, and 41 % of the others.
    In between nothing is known, as stones differ in density: one that is lighter than most of the
    site, and the first one, is raised by another half of the height and weighed again. What hangs
    free weighs the same, and what the ground bears of a stone changes as it tilts. Of 128 trial
    lifts in missions that had passed with less than 0.96 of the stone's weight, as it was known
    later, 34 were placed, of 2,720 others 86 %. Without a monitor that weighs, it only waits.

    It fails, too, if far more hangs in the jaws than the stone was weighed at before: they have
    closed on another one, or on two.

    A lift ends once what hangs is about to tip the machine (`LoadMoment`): it is lowered again to
    where it stood, and this fails.
    A machine on its legs sinks under the load, by up to a decimetre: it lifts on until the gripper
    is as high in the map, and waits at the end while it sways so far that it might tip as it moves.
    An arm that is held back on its way up is told as such only if the whole stone hangs: jaws that
    close on a stone that widens towards the ground slide up on it, and press it down.
    """

    needs = (Robot, Mapper, MotionPlanner, ObjectDatabase, Monitor)
    claims = (Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO

    def run(self, hold: Hold) -> Steps[None]:
        """Lift, weigh and judge.

        Args:
            hold: Which stone is held, and how.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        stone = self.context.use(ObjectDatabase).stone(hold.stone_id)
        before, lifted, load = self.context.arm(), succeeded(), LoadMoment(self.context)
        for number in range(_LIFTS if self.context.machine().stance.is_free else 1):
            way_m = self.settings.height - risen_m(self.context, hold)
            if way_m <= _SUNK * self.settings.height or not lifted.success:
                break
            if number == 0:
                way_m = self._first_m(way_m, stone)
            plan = yield from way_up(self.context, hold, way_m)
            if plan.trajectory is None:
                return succeeded(reason=f"not tried, no path up: {plan.reason}")
            lift = follow(self.context, plan.trajectory, stone.mass_kg)
            lifted = yield from load.limited(lift)
        if load.refusal:
            self._record_overload(hold, stone, load)
            return (yield from self._back(before, lifted))
        return (yield from self._weighed(hold, lifted))

    def _back(self, before: Float, lifted: Outcome[None]) -> Steps[None]:
        """Lower a stone that is too heavy to where it stood; the lift has failed all the same."""
        told = yield from come_to_rest(self.context)
        if not told:
            lowered = yield from way_back(self.context, before[None])
            told = "" if lowered.success else lowered.reason
        return failed(f"{lifted.reason}; it still hangs: {told}") if told else lifted

    def _first_m(self, way_m: float, stone: Stone) -> float:
        """Return how far the first lift goes [m]: the way up, and what the machine sinks by.

        Jaws that close on a stone may push it up before, as less than nothing hangs in them then.
        A load that comes on at once makes it sway, and presses by twice its weight. Where it sinks
        by much, or where that leaves less than a tenth of what holds the machine, the first lift
        only takes the load on: averaged over the period of the sway, it leaves none. So does that
        of a stone that was seen from one side alone, and never weighed: its volume tells too
        little. Of 79 stones of `long_site` the median weighed 1.09 of it, and one in twenty more
        than 1.58; of 272 that a drone had seen as well the median weighed 0.90, one in twenty 0.97.
        """
        machine, q = self.context.machine(), self.context.arm()
        if machine.stance.support_n_m is None:
            return way_m
        from executive.machine.sway import Sway  # reading a mission imports no kinematics
        from executive.machine.tipping_moment import TippingMoment

        sway, hangs_kg = Sway(machine), self.context.payload_kg() or 0.0
        sunk_m = max(sway.sink_m(q, stone.mass_kg) - sway.sink_m(q, hangs_kg), 0.0)
        moment, is_known = TippingMoment(machine), stone.weight or stone.seen_from_above
        least_nm = LEFT * moment.holding_nm(q, 0.0)
        may_tip = (moment.holding_nm(q, 2 * stone.mass_kg) < least_nm).any() or not is_known
        is_much = sunk_m > _SUNK * self.settings.height
        return sunk_m if is_much or (may_tip and sunk_m > 0.0) else way_m + sunk_m

    def _record_overload(self, hold: Hold, stone: Stone, load: LoadMoment) -> None:
        stones = self.context.use(ObjectDatabase).stones()
        sure_kg = asked_of(stone, stones, self.settings.borne).sure_kg
        up_m, tipping_kg = risen_m(self.context, hold), load.tipping_kg
        self.context.record(
            StoneNotLifted(stone.id, up_m, load.hangs_kg, sure_kg, tipping_kg=tipping_kg)
        )

    def _weighed(self, hold: Hold, lifted: Outcome[None]) -> Steps[None]:
        """Wait, weigh the stone meanwhile, and judge it by that, and by how the arm got up."""
        objects = self.context.use(ObjectDatabase)
        stone = objects.stone(hold.stone_id)
        asked = asked_of(stone, objects.stones(), self.settings.borne)
        weight = yield from hanging(self.context, self.settings.wait, asked.sure_kg)
        up_m = risen_m(self.context, hold)
        if weight is None and not lifted.success:
            return lifted
        if weight is None:
            return succeeded(reason=f"it hangs {up_m:.2f} m up, and no monitor weighs it")
        if weight.mass_kg < asked.sure_kg and (
            told := (yield from self._doubted(hold, stone, asked, weight))
        ):
            return failed(told)
        if told := self._too_much(hold, stone, asked, weight):
            return failed(told)
        if not lifted.success:
            return lifted
        yield from calm(self.context, weight.mass_kg)
        self.context.begin_carry(weight)
        self.context.carry_over((yield from self._below(hold)))
        return succeeded(reason=f"it hangs {up_m:.2f} m up with {weight}")

    def _too_much(self, hold: Hold, stone: Stone, asked: Asked, weight: Weight) -> str:
        """Return why what hangs is not the stone alone, by what it was weighed at before."""
        if stone.weight is None:
            return ""
        most_kg, up_m = _MOST * stone.weight.mass_kg, risen_m(self.context, hold)
        if weight.mass_kg - SURE * weight.std_kg <= most_kg:
            return ""
        self.context.record(
            StoneNotLifted(stone.id, up_m, weight.mass_kg, asked.sure_kg, most_kg=most_kg)
        )
        return (
            f"{weight} hang in the jaws, and stone {stone.id} was weighed with {stone.weight}: "
            "another one hangs with it, or it is another one"
        )

    def _doubted(
        self, hold: Hold, stone: Stone, asked: Asked, weight: Weight
    ) -> Generator[Job[Any] | None, Any, str]:
        """Return why the ground still carries a part of a light stone; nothing if it hangs free.

        It is weighed until its weight is known; what may hang free is then raised on, and weighed
        once more.
        """
        up_m = risen_m(self.context, hold)
        weight = (yield from hanging_precisely(self.context, self.settings.wait)) or weight
        may_hang = weight.mass_kg >= asked.least_kg
        second = (yield from self._higher(hold)) if may_hang else None
        if second is not None and are_equal(weight, second):
            return ""
        higher_kg = None if second is None else second.mass_kg
        self.context.record(
            StoneNotLifted(stone.id, up_m, weight.mass_kg, asked.sure_kg, higher_kg)
        )
        borne = _borne(weight, stone, up_m)
        if not may_hang:
            return f"{borne}, and it weighs at least {_least(asked.least_kg, stone)}"
        if second is None:
            return f"{borne}, and it could not be raised on to be weighed once more"
        return f"{borne}, and {second} as it was raised on: what hangs free weighs the same"

    def _higher(self, hold: Hold) -> Generator[Job[Any] | None, Any, Weight | None]:
        """Raise the stone on, and return what hangs there; None if the arm does not get there."""
        plan = yield from way_up(self.context, hold, _HIGHER * self.settings.height)
        if plan.trajectory is None:
            return None
        lift = follow(self.context, plan.trajectory)
        lifted = yield from LoadMoment(self.context).limited(lift)
        if not lifted.success:
            return None
        return (yield from hanging_precisely(self.context, self.settings.wait))

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
