"""Triangle meshes for ray casting."""

from collections.abc import Sequence

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from executive.arrays import Float, Int

Mesh = tuple[Float, Int]  # vertices (V, 3) [m], triangles (F, 3)
Rays = NDArray[np.float32]


class RayMesh:
    """A bounding-volume hierarchy over meshes in one frame, in single precision."""

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        self._scene = o3d.t.geometry.RaycastingScene(nthreads=1)
        self._is_empty = not any(len(triangles) for _, triangles in meshes)
        if not self._is_empty:
            vertices, triangles = joined(meshes)
            self._scene.add_triangles(
                o3d.core.Tensor.from_numpy(vertices.astype(np.float32)),
                o3d.core.Tensor.from_numpy(triangles.astype(np.uint32)),
            )

    def cast(self, rays: Rays) -> NDArray[np.float32]:
        """Return the range to the first surface along each ray, inf for none, shape (N,).

        Args:
            rays: Origins [m] and unit directions, shape (N, 6), contiguous.
        """
        if self._is_empty:
            return np.full(len(rays), np.inf, dtype=np.float32)
        hits = self._scene.cast_rays(
            o3d.core.Tensor.from_numpy(np.ascontiguousarray(rays)), nthreads=1
        )
        return np.asarray(hits["t_hit"].numpy())

    def nearest(self, points: Float) -> tuple[Float, Float]:
        """Return the nearest point of the surface to each point [m], and its triangle's unit
        normal, both of shape (N, 3).

        Args:
            points: Points in the frame of the meshes [m], shape (N, 3).

        Raises:
            ValueError: If there is no surface.
        """
        if self._is_empty:
            raise ValueError("a mesh without triangles has no nearest point")
        tensor = o3d.core.Tensor.from_numpy(np.ascontiguousarray(points, dtype=np.float32))
        found = self._scene.compute_closest_points(tensor, nthreads=1)
        nearest, normals = found["points"].numpy(), found["primitive_normals"].numpy()
        return nearest.astype(np.float64), normals.astype(np.float64)


def moved(mesh: Mesh, T: Float) -> Mesh:
    """Return the mesh transformed into another frame."""
    vertices, triangles = mesh
    return vertices @ T[:3, :3].T + T[:3, 3], triangles


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes of one frame as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes[:-1])])
    vertices = np.concatenate([vertices for vertices, _ in meshes])
    return vertices, np.concatenate(
        [triangles + i for (_, triangles), i in zip(meshes, starts, strict=True)]
    )
