"""The planner of structures with what a mission knows of stones, in trials without a machine.

A mission knows a stone by its hull, a little larger or smaller than it is, and its mass by the
hull's volume. The jaws carry it as it lies. Each stone that stands was seen, with an error.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from executive_plugins.placing.dry_stone.orientations import orientations
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.settings import DryStoneSettings

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.interfaces.building import MayGoOn, StructurePlanner
from executive.messages.building import AsBuilt, BuildPlan, BuildTarget, StandingStone
from executive.messages.solid_stone import SolidStone

ROOM_M = 0.05  # `room` of PlanBuilding
DENSITY_KG_M3 = 2700.0  # of stones that were not weighed, in missions
_KNOWN = 0.015  # standard deviation of the hull's size along each axis, over it
_SEEN_M, _SEEN_RAD = 0.01, np.radians(0.7)  # standard deviations of where a stone was seen
# As trees/build_wall.yaml has it.
SETTINGS = DryStoneSettings.model_validate({
    "generator": {"attitude": "kept", "lean": "29 deg"},
    "check": {"load": 0.14, "most_tilt": "6 deg"},
    "targets": 2,
})  # fmt: skip


def as_it_lies(stone: SolidStone, rng: np.random.Generator) -> SolidStone:
    """Return a stone on its broadest side, under any heading: its frame is that of the ground."""
    R = orientations(stone.vertices, 1, 1, rng.uniform(0.0, 2 * np.pi))[0]
    return SolidStone(stone.name, stone.vertices @ R.T, stone.triangles, stone.mass_kg)


class KnownStonesPlanner(StructurePlanner):
    """Asks `dry_stone` about stones as a mission knows them; poses are of the true stones."""

    def __init__(self, stones: Sequence[SolidStone], rng: np.random.Generator) -> None:
        self._planner = DryStone(SETTINGS)
        self._hulls = {one.name: _hull(one, rng) for one in stones}

    def propose(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn = lambda: True,
    ) -> BuildPlan:
        """Return the plan of `dry_stone` on what is known."""
        standing = [self._seen(one, rng) for one in built.standing]
        known = [self._known(one.name, ROOM_M)[0] for one in inventory]
        plan = self._planner.propose(built.with_standing(*standing), known, rng, may_go_on)
        targets = tuple(self._of_stone(one) for one in plan.targets)
        return replace(plan, targets=targets)

    def _seen(self, one: StandingStone, rng: np.random.Generator) -> StandingStone:
        """Return a standing stone as the last look knows it."""
        hull, centre = self._known(one.stone.name, 0.0)
        off = pose(exp_so3(rng.normal(0.0, _SEEN_RAD, 3)), rng.normal(0.0, _SEEN_M, 3))
        return StandingStone(hull, one.T_map_stone @ pose(t=centre) @ off)

    def _known(self, name: str, room_m: float) -> tuple[SolidStone, Float]:
        """Return the hull of a stone about its own middle, and that in the stone's frame, (3,)."""
        points, centre = self._hulls[name]
        about = points - centre
        away = np.linalg.norm(about[:, :2], axis=1, keepdims=True)
        about[:, :2] *= 1.0 + room_m / np.maximum(away, max(room_m, 1e-9))
        mass_kg = DENSITY_KG_M3 * volume_and_centroid(points)[0]
        return SolidStone(name, *hull_mesh(about), mass_kg, doubt_m=room_m), centre

    def _of_stone(self, target: BuildTarget) -> BuildTarget:
        """Return a target of a hull as one of the stone in it."""
        T_hull_stone = pose(t=-self._hulls[target.stone][1])
        settled = target.T_map_settled @ T_hull_stone
        return replace(target, T_map_stone=target.T_map_stone @ T_hull_stone, T_map_settled=settled)


def _hull(stone: SolidStone, rng: np.random.Generator) -> tuple[Float, Float]:
    """Return the points of a hull as it is known, (N, 3), and its middle, (3,) [m]."""
    points = hull_mesh(stone.vertices)[0] * (1.0 + rng.normal(0.0, _KNOWN, 3))
    return points, volume_and_centroid(points)[1]
