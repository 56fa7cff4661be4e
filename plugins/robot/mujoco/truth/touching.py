"""What each stone touches: other stones, the ground.

MuJoCo keeps no contacts of bodies that are at rest for long, so the shapes are compared.
"""

from collections.abc import Sequence

import fcl
from executive_plugins.physics.fcl_convex import fcl_convex
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.terrain import TERRAIN

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import transform

_TOUCHING_M = 0.02  # between two stones at rest; contacts of the simulation are soft
_ON_GROUND_M = 0.03  # of a corner above the ground


def touching(site: Site, T_world_stones: Sequence[Float]) -> list[tuple[str, ...]]:
    """Return for each stone the names of the stones that it touches, and `terrain`, sorted.

    Args:
        site: The ground, and the stones with their contact hulls.
        T_world_stones: Pose of each stone, (4, 4) each.
    """
    names = [stone.name for stone in site.stones]
    hulls = [transform(T, stone.hull) for stone, T in zip(site.stones, T_world_stones, strict=True)]
    bodies = [_body(hull) for hull in hulls]
    found: list[set[str]] = [set() for _ in names]
    for i, hull in enumerate(hulls):
        if float((hull[:, 2] - site.terrain.height_at(hull[:, :2])).min()) < _ON_GROUND_M:
            found[i].add(TERRAIN)
        for j in range(i):
            if _gap_m(bodies[i], bodies[j]) < _TOUCHING_M:
                found[i].add(names[j])
                found[j].add(names[i])
    return [tuple(sorted(one)) for one in found]


def _body(hull: Float) -> fcl.CollisionObject:
    return fcl.CollisionObject(fcl_convex(*hull_mesh(hull)))


def _gap_m(one: fcl.CollisionObject, other: fcl.CollisionObject) -> float:
    """Return the distance of two bodies [m]; 0 or less where they overlap."""
    return float(fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult()))
