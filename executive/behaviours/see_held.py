"""Look at what is in the jaws."""

from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Radians, Settings
from executive.events.stone import StoneSeenInJaws
from executive.geometry.pose import inverse, transform
from executive.geometry.rotation import angle_between
from executive.interfaces.alignment import Aligner
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.follow import follow
from executive.leaf.form_evidence import ALIKE_OF_ANOTHER, FormEvidence, form_evidence
from executive.leaf.held_pose import HeldPose, held_pose
from executive.leaf.held_starts import STEP_RAD, held_starts
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_surface
from executive.leaf.watched import watched
from executive.leaf.way_up import risen_m, way_up
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.command import SwitchLidars
from executive.messages.hold import Hold

# Two motions are two when they differ by more than the error that a look is allowed, twice.
_APART_M, _APART_RAD = 0.1, 0.15


class SeeHeldSettings(Settings):
    clear: Meters = Field(
        0.7,
        ge=0,
        le=3,
        description="Height by which the stone is off the ground before it is looked at [m].",
    )
    rise: Meters = Field(
        0.5,
        gt=0,
        le=3,
        description="Height by which the stone is then raised while it is looked at [m]. The rings "
        "of the lidars are some 0.2 m apart on it; they sweep over it only while it moves past.",
    )
    max_distance: Meters = Field(0.3, gt=0, le=2, description="Farthest correspondence [m].")
    position_std: Meters = Field(
        0.03,
        gt=0,
        le=1,
        description="Standard deviation of the expected position along each axis [m]: the closing "
        "jaws shift a stone by 1.7 cm in the median, which is 3 cm in the tail that a normal "
        "distribution has to cover. A larger shift that is seen widens it.",
    )
    rotation_std: Radians = Field(
        0.05, gt=0, le=3.2, description="The same of the rotation about each axis [rad]."
    )
    max_turn: Radians = Field(
        1.3,
        gt=0,
        le=3.2,
        description="Turn in the jaws above which a stone is not carried on [rad]. It has rolled "
        "between the tips by most of a right angle, and would come down on another side; 3.2 "
        "carries on whatever its turn.",
    )
    max_unlikelihood: float = Field(
        1e3,
        gt=1,
        description="How many times likelier what is seen may be as another surface than as that "
        "of the stone where it was found. Which stone is held is known, how it lies is not.",
    )
    min_likelihood: float = Field(
        1e3,
        gt=1,
        description="How many times likelier a stone that has slipped has to be where it is found "
        "than another surface, and than the same stone in another place.",
    )


@dataclass(frozen=True, slots=True)
class Look:
    """What a look says of how the stone lies.

    Attributes:
        aligned: The view, laid onto the model.
        is_otherwise: The view is another surface than the stone's where it comes nearest to it. One
            that lies on the stone near where it is expected, and has its form for the most part,
            may show sides of another form: the underside, which nobody has seen before.
    """

    aligned: Alignment
    is_otherwise: bool


@dataclass(frozen=True, slots=True)
class HangSeen:
    """What a look at the stone in the jaws has shown.

    Attributes:
        hang_is_known: Whether the stone was seen as it hangs; otherwise it hangs as it was grasped,
            as far as anybody knows.
    """

    hang_is_known: bool


class SeeHeld(Action[SeeHeldSettings]):
    """Raise a held stone past the lidars, and correct its pose in the jaws by what they see.

    The closing jaws shift and turn a stone, and the motion of the gripper knows nothing of it
    (Mascaro et al. 2020, Eq. 3, starts from the pose before). The lidars' returns around the grasp
    centre, without those of the machine, are aligned with the stone's model from its expected pose.
    The returns are the source: a view from one side lies wholly on the model, and not vice versa.
    If the alignment is refused, or another form is seen, the stone may have slipped: it is sought
    turned about the line through the tips, and lower. If it is found nowhere, or in two places, the
    expected pose is kept. This fails if what is seen contradicts it: nobody knows how the stone
    lies then, and it would be set down on an edge, or onto a neighbour. A view of too little
    contradicts nothing. It fails, too, if the stone is found turned by most of a right angle, with
    its pose corrected: it has rolled between the tips, and would come down on another side.
    """

    needs = (Robot, Mapper, Aligner, MotionPlanner, ObjectDatabase)
    claims = (Part.ARM, Part.CABIN, Part.LIDARS)
    on_resume = OnResume.REDO

    def run(self, hold: Hold) -> Steps[HangSeen]:
        """Raise, look, and correct the database.

        Args:
            hold: Which stone is held, and how.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        risen = yield from self._raise(hold)
        if not risen.success:
            told = f"stone {hold.stone_id} was not seen in the jaws: {risen.reason}"
            return succeeded(HangSeen(False), told)
        view = yield from self.context.job(self.context.use(Mapper).held)
        model = held_surface(self.context, hold)
        look = yield from self._seen(hold, model, view)
        found = self._found(look.aligned, model)
        refused = self._refused(hold, look, found)
        self._record(hold, look.aligned, found, len(view), refused)
        if found is not None:
            self._correct(hold, found)
        if refused:
            return failed(refused)
        if found is None:
            told = f"kept the expected pose of stone {hold.stone_id}: {look.aligned.reason}"
            return succeeded(HangSeen(False), told)
        return succeeded(
            HangSeen(True),
            f"{100 * found.shift_m:.1f} cm and {np.degrees(found.turn_rad):.1f}° from where "
            f"it was expected, ± {100 * found.position_std_m:.1f} cm and "
            f"{np.degrees(found.rotation_std_rad):.1f}°",
        )

    def _raise(self, hold: Hold) -> Generator[Any, Any, Outcome[None]]:
        """Raise the stone straight up, with the lidars on once it is clear of the ground."""
        s = self.settings
        clear_m = hold.T_map_gripper[2, 3] + s.clear
        # From where a trial lift has ended; a stone that hangs higher already passes them, too.
        way_m = max(s.clear - risen_m(self.context, hold), 0.0) + s.rise
        plan = yield from way_up(self.context, hold, way_m)
        if plan.trajectory is None:
            return failed(f"no path up: {plan.reason}")
        robot, are_on = self.context.use(Robot), False

        def look() -> bool:
            nonlocal are_on
            if not are_on and self.context.gripper()[2, 3] >= clear_m:
                robot.command(SwitchLidars(True))
                are_on = True
            return True

        try:
            return (yield from watched(follow(self.context, plan.trajectory), look))
        finally:
            if are_on:
                robot.command(SwitchLidars(False))

    def _seen(self, hold: Hold, model: Float, view: Cloud) -> Generator[Any, Any, Look]:
        """Lay the view onto the model where it is expected, or as a stone that slipped may lie."""
        s = self.settings
        first, form = yield from self._aligned(model, view, np.eye(4), judge_refused=True)
        is_another = form.log_ratio < -np.log(s.max_unlikelihood)
        is_otherwise = is_another and not (first.accepted and form.alike > ALIKE_OF_ANOTHER)
        if first.accepted and is_another:
            words = f"{form.alike:.0%} of what is seen in the jaws has the form of the stone"
            first = replace(first, accepted=False, reason=words)
        turn_rad = angle_between(first.T_target_source[:3, :3], np.eye(3))
        if not len(view) or (first.accepted and turn_rad <= STEP_RAD):
            return Look(first, is_otherwise)
        found = [(form.log_ratio, first)] if first.accepted else []
        tips = self.context.machine().gripper.tips(hold.jaw_rad)
        down = -self.context.gripper()[2, :3]
        for T_moved in held_starts(tips, model, down):
            aligned, form = yield from self._aligned(model, view, inverse(T_moved))
            if aligned.accepted and form.log_ratio >= np.log(s.min_likelihood):
                found.append((form.log_ratio, aligned))
        if not found:
            return Look(first, is_otherwise)
        best_log, best = max(found, key=lambda one: one[0])
        rivals = (one for log, one in found if best_log - log < np.log(s.min_likelihood))
        if any(_is_apart(best, one, model.mean(axis=0)) for one in rivals):
            words = "it may lie in the jaws in two ways"
            return Look(replace(best, accepted=False, reason=words), is_otherwise=True)
        return Look(best, is_otherwise=False)

    def _aligned(
        self, model: Float, view: Cloud, T_model_view: Float, *, judge_refused: bool = False
    ) -> Generator[Any, Any, tuple[Alignment, FormEvidence]]:
        """Lay the view onto the model from a start, and compare their forms."""
        reach_m = self.settings.max_distance
        aligned = yield from self.context.job(
            self.context.use(Aligner).align,
            *(Cloud("gripper", model), view, T_model_view, reach_m),
        )
        if not (aligned.accepted or (judge_refused and len(view))):
            return aligned, FormEvidence(0.0, 0.0)
        seen = aligned.apply(view.points)
        return aligned, (
            yield from self.context.job(form_evidence, seen, model, reach_m, hangs=True)
        )

    def _found(self, aligned: Alignment, model: Float) -> HeldPose | None:
        if not aligned.accepted or aligned.uncertainty is None:
            return None
        s = self.settings
        T_model = inverse(aligned.T_target_source)  # the view was laid onto the model
        return held_pose(
            T_model, aligned.uncertainty, model.mean(axis=0), s.position_std, s.rotation_std
        )

    def _refused(self, hold: Hold, look: Look, found: HeldPose | None) -> str:
        """Return why the stone is not carried on as it lies in the jaws; empty if it is."""
        if found is None and look.is_otherwise:
            return (
                f"stone {hold.stone_id} does not lie in the jaws as expected, and how it lies is "
                f"not known: {look.aligned.reason}"
            )
        if found is not None and found.turn_rad > self.settings.max_turn:
            return (
                f"stone {hold.stone_id} has turned in the jaws by {np.degrees(found.turn_rad):.0f}°"
                f", and at most {np.degrees(self.settings.max_turn):.0f}° is carried on"
            )
        return ""

    def _correct(self, hold: Hold, found: HeldPose) -> None:
        """Move the stone in the database, which has it where the jaws closed."""
        T_map_map = hold.T_map_gripper @ found.T_gripper_gripper @ inverse(hold.T_map_gripper)
        note = f"in the jaws, {100 * found.shift_m:.1f} cm, {found.turn_rad:.3f} rad"
        objects = self.context.use(ObjectDatabase)
        stone = objects.realign(hold.stone_id, T_map_map, self.context.now_s(), note)
        T_now_then = self.context.gripper() @ inverse(hold.T_map_gripper)
        self.context.show("held", Cloud("map", transform(T_now_then, stone.points_map)))

    def _record(
        self, hold: Hold, aligned: Alignment, found: HeldPose | None, points: int, refused: str
    ) -> None:
        self.context.record(
            StoneSeenInJaws(
                stone=hold.stone_id,
                accepted=found is not None,
                reason="" if found is not None else aligned.reason,
                points=points,
                shift_m=None if found is None else found.shift_m,
                turn_rad=None if found is None else found.turn_rad,
                position_std_m=None if found is None else found.position_std_m,
                rotation_std_rad=None if found is None else found.rotation_std_rad,
                refused=refused,
            )
        )


def _is_apart(one: Alignment, other: Alignment, centre: Float) -> bool:
    """Return whether two motions of the model differ by more than they err."""
    T = inverse(one.T_target_source) @ other.T_target_source
    shift_m = float(np.linalg.norm(T[:3, :3] @ centre + T[:3, 3] - centre))
    return shift_m > _APART_M or angle_between(T[:3, :3], np.eye(3)) > _APART_RAD
