"""Headings of the cabin: the arm's positions that turn it there."""

from typing import Literal

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Radians, Settings
from executive.geometry.rotation import wrap_angle, yaw_of
from executive.leaf.context import Context


class HeadingSettings(Settings):
    heading: Radians = Field(
        ge=-2 * np.pi,
        le=2 * np.pi,
        examples=["90 deg"],
        description="Where the cabin is to look [rad]: 0 along the x axis, positive to the left.",
    )
    relative_to: Literal["chassis", "map"] = Field(
        "chassis", description="Whose x axis is 0: the chassis', or that of the map's frame."
    )


def facing(context: Context, settings: HeadingSettings) -> Float:
    """Return the arm's present positions with the cabin turned to a heading, shape (n,).

    The chassis is taken as level: tilted by 5 deg, it is off by less than 0.3 deg.
    """
    machine, goal = context.machine(), context.arm()
    turn = machine.arm_names.index(machine.turn_joint)
    joint, heading_rad = machine.joints[turn], settings.heading
    if settings.relative_to == "map":
        heading_rad -= yaw_of(context.state().T_map_base[:3, :3])
    zero_rad = yaw_of(joint.T_parent_joint[:3, :3])
    goal[turn] = np.copysign(1.0, joint.axis[2]) * wrap_angle(heading_rad - zero_rad)
    return goal
