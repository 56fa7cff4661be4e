"""Drive the jaws without lifting the machine: what opens and closes at a stone shares it."""

from collections.abc import Generator
from dataclasses import dataclass

from executive.leaf.context import Context
from executive.leaf.jaws import drive_jaws
from executive.leaf.job import Job
from executive.leaf.raise_gripper import raise_gripper
from executive.leaf.thrust import Thrust
from executive.machine.jaw_clearance import tips_sink_m

_STEP_M = 0.05  # by which the gripper is raised at once


@dataclass(frozen=True, slots=True)
class LightDrive:
    """How a drive of the jaws ended.

    Attributes:
        angle_rad: Where the jaws rest [rad].
        is_whole: Whether they moved until they met their goal or a stone, and not the thrust.
        told: What thrust and load have made of the drive; empty if there was none.
    """

    angle_rad: float
    is_whole: bool
    told: str


def drive_lightly(
    context: Context, position_rad: float, force_n: float | None, stone: int
) -> Generator[Job[object] | None, object, LightDrive]:
    """Drive the jaws, so that they neither lift the machine nor take on a load at once.

    The tips of jaws that swing about their pivots come down on the way, deepest where the gripper
    is rolled, and press on the ground or on a stone that stands there with the force of the jaws.
    The gripper is raised by as much in all, and by the depth to which teeth may be in soil. What
    they lift as they close is taken on in steps where it would tip the machine as it sways on.

    Args:
        context: The leaf's view of the mission; it needs robot, motion, mapping and objects.
        position_rad: Where the jaws are to be [rad].
        force_n: Force at each tip [N]; None for the gripper's own.
        stone: Id of the stone at the jaws, which is no obstacle.
    """
    jaw, gripper = context.machine().jaw.name, context.machine().gripper
    from_rad, up = context.joints().of(jaw)[0], context.gripper()[2, :3]
    most_m = gripper.digs_m + tips_sink_m(gripper, up, from_rad, position_rad)
    thrust, risen_m = Thrust(context), 0.0
    while True:
        thrust.begin_drive()
        angle_rad = yield from drive_jaws(
            context, position_rad, force_n, thrust.is_too_much, lambda: thrust.is_too_sudden
        )
        if not thrust.was_too_much:
            told = [_told(f"the gripper was raised by {risen_m:.2f} m")] if risen_m else []
            if thrust.waited_s:
                told.append(f"the jaws waited {thrust.waited_s:.1f} s, as they lifted a load")
            return LightDrive(angle_rad, True, "; ".join(told))
        why = "raised as far as it may be"
        if risen_m < most_m:
            why = yield from raise_gripper(context, stone, _STEP_M)
        if why:
            short = f"the jaws stopped at {angle_rad:.2f} of {position_rad:.2f} rad"
            return LightDrive(angle_rad, False, _told(f"{short} ({why})"))
        risen_m += _STEP_M


def _told(what: str) -> str:
    return f"{what}, because the jaws pressed so hard that they would have lifted the machine"
