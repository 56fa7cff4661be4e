"""Which stones really stand in a structure, as a judge is handed them."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.terrain import Terrain
from executive_plugins.robot.mujoco.truth.touching import touching

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure

_AROUND_M = 2.0  # of ground around a structure


def stones_over(structure: Structure, poses: Sequence[Float]) -> list[int]:
    """Return the indices of the stones whose middles are over the foot of a structure.

    Args:
        structure: What was to be built.
        poses: Pose of each stone of the site, (4, 4) each.
    """
    if not poses:
        return []
    middles = np.array([T[:2, 3] for T in poses])
    return np.flatnonzero(structure.depth_m(middles, np.zeros(len(poses))) >= 0.0).tolist()


def as_built(structure: Structure, site: Site, poses: Sequence[Float]) -> AsBuilt:
    """Return a structure with the stones that stand in it, lowest first, on the site's ground.

    A stone beside the foot that one of them touches belongs to it: it may hold what leans on it. A
    stone has the shape by which it touches, the convex hull of its skin, and the mass of its skin.
    """
    standing = []
    for i in _with_beside(stones_over(structure, poses), site, poses):
        model = site.stones[i]
        corners, triangles = hull_mesh(model.hull)
        solid = SolidStone(model.name, corners, triangles, model.mass_kg)
        standing.append(StandingStone(solid, poses[i]))
    standing.sort(key=lambda one: float(one.T_map_stone[2, 3]))
    return AsBuilt(structure, _ground(structure, site.terrain), tuple(standing))


def _with_beside(stones: Sequence[int], site: Site, poses: Sequence[Float]) -> list[int]:
    """Return stones, and all that touch one of them, directly or through others."""
    if not stones:
        return []
    of_name = {one.name: i for i, one in enumerate(site.stones)}
    touches = touching(site, poses)
    found = list(stones)
    for i in found:  # grows while it is gone through
        beside = (of_name[name] for name in touches[i] if name in of_name)
        found += [j for j in beside if j not in found]
    return sorted(found)


def _ground(structure: Structure, terrain: Terrain) -> HeightGrid:
    """Return the terrain around a structure by its own nodes: other ones make other facets."""
    low, high = structure.bounds()
    nodes = terrain.coordinates_m
    first = np.maximum(np.searchsorted(nodes, low - _AROUND_M, side="right") - 1, 0)
    last = np.minimum(np.searchsorted(nodes, high + _AROUND_M), len(nodes) - 1)
    (x, y) = (slice(a, b + 1) for a, b in zip(first, last, strict=True))
    return HeightGrid(nodes[first], float(nodes[1] - nodes[0]), terrain.heights_m[x, y])
