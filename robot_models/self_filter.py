"""Returns from the machine itself, found by the shapes of its links (Mascaro 2020, Sec. 4.2, step 1)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.spatial import ConvexHull

from executive.arrays import Bool, Float, Int
from executive.geometry.pose import inverse
from robot_models.machine import Machine


@njit(cache=True)  # type: ignore[untyped-decorator]
def _inside(points: Float, slices: Int, planes: Float, starts: Int, spheres: Float) -> Bool:
    """Tell which points are in a shape: within its sphere and behind all its planes."""  # pragma: no cover - compiled
    found = np.zeros(len(points), dtype=np.bool_)
    for n in range(len(points)):
        x, y, z = points[n]
        s = slices[n]
        for shape in range(len(starts) - 1):
            cx, cy, cz, radius = spheres[s, shape]
            if (x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2 > radius * radius:
                continue
            inside = True
            for p in range(starts[shape], starts[shape + 1]):
                a, b, c, d = planes[s, p]
                if a * x + b * y + c * z > d:
                    inside = False
                    break
            if inside:
                found[n] = True
                break
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Hull:
    """A padded convex shape in its link's frame: planes n·p ≤ d, shape (P, 4), and a sphere around it."""

    link: str
    planes: Float
    centre: Float
    radius_m: float


class SelfFilter:
    """Padded hulls of all links, and the ball of a held stone."""

    def __init__(self, machine: Machine, padding_m: float) -> None:
        shapes = [(name, shape.vertices) for name, link in machine.links.items() for shape in link.shapes]
        self._hulls = tuple(_hull(name, vertices, padding_m) for name, vertices in shapes)
        counts = [len(hull.planes) for hull in self._hulls]
        # The last shape has no planes: a ball alone, around what the gripper holds.
        self._starts = np.concatenate([[0], np.cumsum([*counts, 0])]).astype(np.int64)
        self._grasp_centre = machine.gripper.grasp_centre

    def inside(
        self, points_lidar: Float, slices: Int, lidar: str, frames: list[Mapping[str, Float]], held_radius_m: float
    ) -> Bool:
        """Tell which returns lie on the machine or on what it holds.

        Args:
            points_lidar: Returns in the sensor's frame [m], shape (N, 3).
            slices: For each point the row of `frames` of its time, shape (N,).
            lidar: Name of the sensor's frame.
            frames: T_base_frame by name, for each slice of time.
            held_radius_m: Radius of the ball around the space between the jaws [m]; 0 for none.
        """
        posed = [self._posed(frame, inverse(frame[lidar]), held_radius_m) for frame in frames]
        planes, spheres = (np.array([each[k] for each in posed]) for k in (0, 1))
        return np.asarray(_inside(points_lidar, slices, planes, self._starts, spheres))

    def _posed(self, frames: Mapping[str, Float], T_lidar_base: Float, held_radius_m: float) -> tuple[Float, Float]:
        """Return all planes and spheres in the sensor's frame, shapes (P, 4) and (S, 4)."""
        planes, spheres = [], []
        for hull in self._hulls:
            T = T_lidar_base @ frames[hull.link]
            normals = hull.planes[:, :3] @ T[:3, :3].T
            planes.append(np.column_stack([normals, hull.planes[:, 3] + normals @ T[:3, 3]]))
            spheres.append([*(T[:3, :3] @ hull.centre + T[:3, 3]), hull.radius_m])
        T = T_lidar_base @ frames["gripper"]
        spheres.append([*(T[:3, :3] @ self._grasp_centre + T[:3, 3]), held_radius_m])
        return np.vstack(planes), np.array(spheres)


def _hull(link: str, vertices: Float, padding_m: float) -> _Hull:
    facets = ConvexHull(vertices).equations  # n·p + offset ≤ 0
    planes = np.unique(np.round(np.column_stack([facets[:, :3], -facets[:, 3]]), 9), axis=0)
    planes[:, 3] += padding_m
    centre = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    # √3: a padded box's corner is that much farther than its faces
    radius_m = float(np.linalg.norm(vertices - centre, axis=1).max()) + np.sqrt(3) * padding_m
    return _Hull(link, planes, centre, radius_m)
