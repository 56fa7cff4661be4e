"""Slots along a structure: stones side by side on the ground, as `slots` lays a row, no courses.

The simplest plan for a row, a ring or the first course of a wall, and the smallest example of a
building planner.
"""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from executive_plugins.physics.even_directions import even_directions
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.interfaces.building import MayGoOn, StructurePlanner
from executive.interfaces.declaration import PluginSettings
from executive.messages.building import AsBuilt, BuildPlan, BuildTarget
from executive.messages.solid_stone import SolidStone

_UP = np.array([0.0, 0.0, 1.0])
_DIRECTIONS = 200  # over which the lowest attitude of a stone is looked for


class SideBySideSettings(PluginSettings):
    """Settings of `side_by_side`."""

    gap: Meters = Field(0.1, ge=0, le=5, description="Gap between two stones [m].")


class SideBySide(StructurePlanner):
    """Lay the stones in the order of the inventory, flat, along the centre line."""

    Settings: ClassVar[type[Settings]] = SideBySideSettings
    is_stateless: ClassVar[bool] = True

    def __init__(self, settings: SideBySideSettings) -> None:
        self._settings = settings

    def propose(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn = lambda: True,
    ) -> BuildPlan:
        """Return the place of the first stone of the inventory that the line has room for."""
        if not inventory:
            return BuildPlan((), "no_stones", {})
        begin_m = self._end_of(built)
        refused = 0
        for stone in inventory:
            R = _flat(stone, built.structure.heading_rad(begin_m))
            turned = stone.vertices @ R.T
            along = turned[:, :2] @ _direction(built.structure.heading_rad(begin_m))
            middle_m = begin_m - float(along.min())
            if middle_m + float(along.max()) > built.structure.length_m + 1e-9:
                refused += 1
                continue
            at = built.structure.point(middle_m)
            foot = float((built.ground.at(turned[:, :2] + at) - turned[:, 2]).max())
            T = pose(R, np.array([*at, foot]))
            target = BuildTarget(stone.name, T, T, -_UP, 0.0, 0.0, 0.0, 0.0, {})
            return BuildPlan((target,), None, {"no_room": refused} if refused else {})
        return BuildPlan((), "nothing_fits", {"no_room": refused}, "the line is full")

    def _end_of(self, built: AsBuilt) -> float:
        """Return the length along the line at which the next stone begins [m]."""
        if not built.standing:
            return 0.0
        points = np.vstack([one.vertices_map() for one in built.standing])
        return float(built.structure.along_across(points[:, :2])[0].max()) + self._settings.gap


def _direction(heading_rad: float) -> Float:
    return np.array([np.cos(heading_rad), np.sin(heading_rad)])


def _flat(stone: SolidStone, heading_rad: float) -> Float:
    """Return the rotation that lays a stone lowest, its longer side from above along a heading."""
    heights = [float(np.ptp(stone.vertices @ up)) for up in even_directions(_DIRECTIONS)]
    up = even_directions(_DIRECTIONS)[int(np.argmin(heights))]
    axis = np.cross(up, _UP)
    sine = float(np.linalg.norm(axis))
    R = about_axis(axis / sine, float(np.arctan2(sine, up[2]))) if sine > 1e-9 else np.eye(3)
    xy = (stone.vertices @ R.T)[:, :2]
    longest = np.linalg.svd(xy - xy.mean(axis=0), full_matrices=False)[2][0]
    return about_axis(_UP, heading_rad - float(np.arctan2(longest[1], longest[0]))) @ R
