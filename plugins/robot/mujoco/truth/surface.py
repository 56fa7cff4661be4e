"""The true surface of a site, to compare maps and surveys with."""

import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import RayMesh, moved
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.truth.truth_log import TruthLog

from executive.arrays import Float
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import angle_between, exp_so3
from executive.interfaces.truth import Distances, MapErrors, Nothing, RegistrationErrors

_SAMPLE = 20_000  # points that are compared; more change the figures by less than a hundredth
_ITERATIONS = 20  # of the fit; it converges in five to ten
_UNKNOWNS = 6  # of the fit
_FAR_M = 0.5  # points farther from the surface are no part of it, such as those of the machine


class TrueSurface:
    """Ground and stones as they are at a time.

    Args:
        site: Shapes of the ground and the stones.
        log: Poses of the stones.
        time_s: The time [s].
    """

    def __init__(self, site: Site, log: TruthLog, time_s: float) -> None:
        stones = [
            moved((stone.vertices, stone.triangles), log.T_world_stone(i, time_s))
            for i, stone in enumerate(site.stones)
        ]
        self._mesh = RayMesh([site.terrain.mesh(), *stones])

    def distances(self, points_map: Float) -> Nothing | MapErrors:
        """Return the distances of points to the surface; nothing without points.

        Args:
            points_map: Points in the map [m], shape (N, 3); of many every nth is taken.
        """
        if not len(points_map):
            return Nothing()
        points = _sample(points_map)
        nearest, normals = self._mesh.nearest(points)
        distances = np.linalg.norm(nearest - points, axis=1)
        median, p95 = np.percentile(distances, [50, 95])
        outwards = np.sign(np.einsum("ij,ij->i", points - nearest, normals))
        signed = (outwards * distances)[distances < _FAR_M]
        return MapErrors(
            distance_m=Distances(float(median), float(p95)),
            bias_m=float(signed.mean()) if len(signed) else None,
            std_m=float(signed.std()) if len(signed) else None,
        )

    def misplacement(self, points_map: Float) -> Nothing | RegistrationErrors:
        """Return how far a cloud as a whole is from where it fits the surface best.

        The fit is rigid and minimises distances to the planes of the nearest triangles.

        Args:
            points_map: Points in the map [m], shape (N, 3); of many every nth is taken.

        Returns:
            How far the fit moves the middle of the points, and how far it turns them; nothing
            without points near the surface.
        """
        points = _sample(points_map)
        if not len(points):
            return Nothing()
        T = np.eye(4)
        for _ in range(_ITERATIONS):
            placed = transform(T, points)
            nearest, normals = self._mesh.nearest(placed)
            is_near = np.linalg.norm(nearest - placed, axis=1) < _FAR_M
            if is_near.sum() < _UNKNOWNS:
                return Nothing()
            T = _step(placed[is_near], nearest[is_near], normals[is_near]) @ T
        middle = points.mean(axis=0)
        return RegistrationErrors(
            error_m=float(np.linalg.norm(transform(T, middle[None])[0] - middle)),
            error_rad=angle_between(np.eye(3), T[:3, :3]),
        )


def _step(points: Float, nearest: Float, normals: Float) -> Float:
    """Return the motion that brings points nearest to the planes of their partners, (4, 4).

    Source: Chen & Medioni 1992, Image and Vision Computing 10(3), 145–155, linearised.
    """
    J = np.hstack([np.cross(points, normals), normals])
    residuals = np.einsum("ij,ij->i", nearest - points, normals)
    rotation, shift = np.split(np.linalg.lstsq(J, residuals, rcond=None)[0], 2)
    return pose(exp_so3(rotation), shift)


def _sample(points: Float) -> Float:
    return points[:: max(1, len(points) // _SAMPLE)]
