"""Swing the cabin with the lidars on: the step that leaves which scan share."""

from pydantic import Field

from executive.arrays import Float
from executive.config import Radians, Seconds, Settings
from executive.events.site import SiteScanned
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.leaf.action import Steps
from executive.leaf.context import Context
from executive.leaf.follow import follow
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import map_cloud
from executive.messages.command import SwitchLidars
from executive.messages.request import Around


class SwingSettings(Settings):
    angle: Radians = Field(2.094, gt=0, le=6.3, description="Whole angle of the sweep [rad].")
    duration: Seconds = Field(20.0, gt=0, le=300, description="Least duration of the sweep [s].")


def swing(
    context: Context,
    settings: SwingSettings,
    held_gripper: Float | None = None,
    held_kg: float | None = None,
) -> Steps[None]:
    """Fold the arm and swing the cabin about its present heading; the lidars are off afterwards.

    The swing must be free in the map as it is: a first swing meets what no scan has shown yet.

    Args:
        context: The leaf's view of the mission; it needs robot, mapping and motion.
        settings: Angle and duration.
        held_gripper: Surface of a held stone in the gripper's frame [m], shape (N, 3), or None.
        held_kg: The most that the held stone weighs [kg]; None if it was not weighed.

    Source: Mascaro et al. 2020, Sec. 6.2.
    """
    if moving := (yield from come_to_rest(context)):
        return failed(moving)
    obstacles = yield from map_cloud(context)
    around = Around(
        T_map_base=context.state().T_map_base,
        obstacles=obstacles,
        jaw_rad=context.joints().of(context.machine().jaw.name)[0],
        held_gripper=held_gripper,
        held_kg=held_kg,
    )
    plan = yield from context.job(
        context.use(MotionPlanner).swing, context.arm(), settings.angle, settings.duration, around
    )
    if plan.trajectory is None:
        return failed(f"no swing: {plan.reason}")
    robot = context.use(Robot)
    robot.command(SwitchLidars(True))
    try:
        outcome = yield from follow(context, plan.trajectory)
    finally:
        robot.command(SwitchLidars(False))
    cloud = yield from map_cloud(context)
    context.record(SiteScanned(len(cloud)))
    context.show("map", cloud)
    if not outcome.success:
        return outcome
    return succeeded(reason=f"{len(cloud)} points in the map")
