"""What stands on a site and never moves: walls, parked machines, trunks of trees."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh
from executive_plugins.robot.mujoco.site.settings import ObstacleSettings
from executive_plugins.robot.mujoco.site.terrain import Terrain

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis, quaternion_wxyz

_SIDES = 16  # corners of a round obstacle for rays: at most 2 % inside its circle
_BURIED_M = 0.5  # below the lowest ground under it, so that no gap is left on a slope


@dataclass(frozen=True, slots=True, eq=False)
class Obstacle:
    """A solid that is fixed to the ground.

    Attributes:
        name: Its geometry in MuJoCo, and its name in the report.
        T_world_obstacle: Pose of its middle, shape (4, 4).
        half_size_m: Half of its length, width and height [m], shape (3,).
        shape: A box, or an upright cylinder as wide as it is long.
    """

    name: str
    T_world_obstacle: Float
    half_size_m: Float
    shape: Literal["box", "cylinder"]

    def mesh(self) -> Mesh:
        """Return its surface in the world."""
        if self.shape == "box":
            sides = np.array([[-1, -1], [-1, 1], [1, 1], [1, -1]])
        else:
            angles = np.arange(_SIDES) * 2 * np.pi / _SIDES
            sides = np.c_[np.cos(angles), np.sin(angles)]
        corners = np.vstack([np.c_[sides, np.full(len(sides), z)] for z in (-1.0, 1.0)])
        return hull_mesh(transform(self.T_world_obstacle, corners * self.half_size_m))

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add it to a world, as a part of the ground."""
        is_box = self.shape == "box"
        half = self.half_size_m if is_box else self.half_size_m[[0, 2, 2]]
        spec.worldbody.add_geom(
            name=self.name,
            type=mujoco.mjtGeom.mjGEOM_BOX if is_box else mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=half.tolist(),
            pos=self.T_world_obstacle[:3, 3].tolist(),
            quat=quaternion_wxyz(self.T_world_obstacle[:3, :3]).tolist(),
            rgba=[0.55, 0.36, 0.28, 1.0] if is_box else [0.36, 0.27, 0.18, 1.0],
        )


def make_obstacles(settings: Sequence[ObstacleSettings], terrain: Terrain) -> tuple[Obstacle, ...]:
    """Stand the obstacles on the ground, `obstacle_1` first."""
    return tuple(_standing(f"obstacle_{i}", one, terrain) for i, one in enumerate(settings, 1))


def _standing(name: str, settings: ObstacleSettings, terrain: Terrain) -> Obstacle:
    length, width, height = settings.size_m
    if settings.shape == "cylinder":
        width = length
    R = about_axis(np.array([0.0, 0.0, 1.0]), settings.yaw_rad)
    corners = np.array([[x, y, 0.0] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    at = np.array([*settings.at_m, 0.0])
    under = terrain.height_at((corners * [length, width, 0] @ R.T + at)[:, :2])
    bottom, top = float(under.min()) - _BURIED_M, float(under.max()) + height
    at[2] = (bottom + top) / 2
    return Obstacle(name, pose(R, at), np.array([length, width, top - bottom]) / 2, settings.shape)
