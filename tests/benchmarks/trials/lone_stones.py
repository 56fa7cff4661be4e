"""Single stones at rest on level ground, unseen in training: generated ones, and scans from a
folder.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import open3d as o3d
from executive_plugins.grasping.learning.labels import LabelSettings, resting_stone
from executive_plugins.grasping.learning.training_scene import Solid, at_rest, convex_solid
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin

from executive.arrays import Float, Int
from executive.geometry.convex import convex_corners
from executive.geometry.pose import pose, transform

_SCALE, _VOLUME_M3 = 10.0, (0.1, 1.1)  # what the gripper is made for: as in LabelSettings


def generated(settings: LabelSettings, seed: int) -> Iterator[tuple[Float, Solid]]:
    """Yield hulls [m], shape (V, 3), and what a sensor sees of them, without end."""
    i = 0
    while True:
        hull = resting_stone(settings, np.random.default_rng((seed, i)))
        yield hull, convex_solid(hull)
        i += 1


def scanned(folder: Path, seed: int) -> Iterator[tuple[Float, Solid]]:
    """Yield those of the scans in a folder that come to rest and are of a size that the gripper is
    made for.
    """
    for i, path in enumerate(mesh_files(folder)):
        vertices, triangles = read_skin(path, _SCALE)
        hull = convex_corners(vertices)
        T = at_rest(hull, np.random.default_rng((seed, i)))
        volume_m3 = abs(np.linalg.det(vertices[triangles]).sum()) / 6
        if T is None or not _VOLUME_M3[0] <= volume_m3 <= _VOLUME_M3[1]:
            continue
        T = pose(t=-np.append(transform(T, hull)[:, :2].mean(axis=0), 0.0)) @ T
        yield transform(T, hull), mesh_solid(transform(T, vertices), triangles)


def mesh_solid(vertices: Float, triangles: Int) -> Solid:
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(vertices.astype(np.float32), triangles.astype(np.uint32))

    def cast(origin: Float, directions: Float) -> Float:
        rays = np.column_stack([np.tile(origin, (len(directions), 1)), directions]).astype(
            np.float32
        )
        return scene.cast_rays(o3d.core.Tensor(rays))["t_hit"].numpy().astype(float)

    return cast
