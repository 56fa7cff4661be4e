"""Swing the cabin with the lidars on: the step that leaves which scan share."""

from collections.abc import Generator
from typing import Any

from pydantic import Field

from executive.config import Radians, Seconds, Settings
from executive.events.site import SiteScanned
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.leaf.context import Context
from executive.leaf.follow import follow
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.messages.command import SwitchLidars
from executive.messages.request import Around


class SwingSettings(Settings):
    angle: Radians = Field(2.094, gt=0, le=6.3, description="Whole angle of the sweep [rad].")
    duration: Seconds = Field(20.0, gt=0, le=300, description="Least duration of the sweep [s].")


def swing(context: Context, settings: SwingSettings) -> Generator[Any, Any, Outcome[None]]:
    """Fold the arm and swing the cabin about its present heading; the lidars are off afterwards.

    The swing must be free in the map as it is: a first swing meets what no scan has shown yet.

    Source: Mascaro et al. 2020, Sec. 6.2.
    """
    if moving := (yield from come_to_rest(context)):
        return failed(moving)
    around = Around(
        T_map_base=context.state().T_map_base,
        obstacles=context.use(Mapper).cloud(),
        jaw_rad=context.joints().of(context.machine().jaw.name)[0],
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
    cloud = context.use(Mapper).cloud()
    context.record(SiteScanned(len(cloud)))
    context.show("map", cloud)
    if not outcome.success:
        return outcome
    return succeeded(reason=f"{len(cloud)} points in the map")
