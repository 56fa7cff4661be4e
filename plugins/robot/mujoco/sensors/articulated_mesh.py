"""One mesh of the surfaces of several moving bodies."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh, joined

from executive.arrays import Float, Int


@dataclass(frozen=True, slots=True, eq=False)
class ArticulatedMesh:
    """Meshes in the frames of their bodies.

    Attributes:
        vertices: Vertices in the frame of the owning body [m], shape (V, 3).
        owners: Index of the body of each vertex among all bodies, shape (V,).
        triangles: Counter-clockwise from outside, shape (F, 3).
        starts: Index of the first vertex of each part, shape (P,).
    """

    vertices: Float
    owners: Int
    triangles: Int
    starts: Int

    @classmethod
    def of(cls, parts: Sequence[tuple[int, Mesh]]) -> "ArticulatedMesh":
        """Join meshes, each given with the index of its body; no parts give an empty mesh."""
        if not parts:
            none = np.zeros(0, dtype=np.int64)
            return cls(np.zeros((0, 3)), none, np.zeros((0, 3), dtype=np.int64), none)
        vertices, triangles = joined([mesh for _, mesh in parts])
        sizes = [len(mesh[0]) for _, mesh in parts]
        owners = np.repeat([body for body, _ in parts], sizes)
        return cls(vertices, owners, triangles, np.cumsum([0, *sizes[:-1]]))

    def posed(self, positions: Float, rotations: Float, T_world_frame: Float) -> Mesh:
        """Return the mesh in a frame.

        Args:
            positions: Positions of all bodies in the world [m], shape (B, 3).
            rotations: Their rotations, shape (B, 3, 3).
            T_world_frame: Pose of the frame, shape (4, 4).
        """
        world = (
            np.einsum("vij,vj->vi", rotations[self.owners], self.vertices) + positions[self.owners]
        )
        return (world - T_world_frame[:3, 3]) @ T_world_frame[:3, :3], self.triangles

    def boxes(self, vertices: Float) -> tuple[Float, Float]:
        """Return the lowest and the highest corner of each part, shape (P, 3) each.

        Args:
            vertices: Those of `posed`, shape (V, 3).
        """
        if not len(self.starts):
            return vertices, vertices
        return (
            np.minimum.reduceat(vertices, self.starts),
            np.maximum.reduceat(vertices, self.starts),
        )
