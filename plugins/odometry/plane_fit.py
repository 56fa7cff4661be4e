"""Registration of a scan to planes by Gauss-Newton on point-to-plane distances."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.odometry.plane_map import PlaneMap

from executive.arrays import Float
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3

_MOST_STEPS = 20
# [rad] and [m]: a twentieth of the noise; below it, correspondences alternate between steps.
_SMALL_STEP = 2e-4
_GATE = 0.4  # of the search distance; a plane that is farther away is another surface
# Mean squared cosine between a direction and the normals. Range noise of 20 mm on level ground
# gives 1.3e-4 along the ground and 2e-5 in heading; a site with seven stones gives 7e-4 and more.
_LEAST_SQUARED_COSINE = 2.5e-4
_LEAST_STD_M = 0.005  # lower bound on the standard deviation of a distance


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """Predicted pose of a scan.

    Attributes:
        T_map_lidar: Pose, shape (4, 4).
        std: Standard deviation of its error as (rotation [rad], translation [m]), shape (6,). It
            decides the directions that the scene does not constrain.
    """

    T_map_lidar: Float
    std: Float


@dataclass(frozen=True, slots=True, eq=False)
class PlaneFit:
    """A registered scan.

    Attributes:
        T_map_lidar: Pose, shape (4, 4).
        covariance: Of its error as (rotation, translation) in the lidar's frame, shape (6, 6).
        share: Share of the points that lie on a plane.
        has_converged: Whether the steps became small.
    """

    T_map_lidar: Float
    covariance: Float
    share: float
    has_converged: bool


def fit(
    points_lidar: Float, planes: PlaneMap, guess: Guess, first_m: float, last_m: float
) -> PlaneFit:
    """Register a scan; the search distance is halved at each step, from `first_m` to `last_m` [m].

    The covariance is that of the least squares, with the spread of the distances and the guess as
    a prior. A direction that no plane constrains keeps the guess and its uncertainty.
    """
    T: Float = guess.T_map_lidar
    reach_m = first_m
    prior: Float = np.diag(1 / guess.std**2)
    information: Float = prior
    share, has_converged = 0.0, False
    for _ in range(_MOST_STEPS):
        J, distances_m = _distances(points_lidar, planes, T, reach_m)
        std_m = max(
            1.4826 * float(np.median(np.abs(distances_m))) if len(distances_m) else reach_m,
            _LEAST_STD_M,
        )
        weights = 1 / np.maximum(np.abs(distances_m) / (1.5 * std_m), 1)  # Huber
        weighted = J * weights[:, None] / std_m**2
        held = _held(weighted.T @ J, points_lidar, float((weights / std_m**2).sum()))
        information = np.asarray(held @ weighted.T @ J @ held.T + prior, dtype=np.float64)
        step = np.asarray(
            np.linalg.solve(information, -held @ weighted.T @ distances_m), dtype=np.float64
        )
        T = T @ pose(exp_so3(step[:3]), step[3:])
        share = len(distances_m) / len(points_lidar)
        if reach_m <= last_m and np.abs(step).max() < _SMALL_STEP:
            has_converged = True
            break
        reach_m = max(0.5 * reach_m, last_m)
    covariance = np.asarray(np.linalg.inv(information), dtype=np.float64)
    return PlaneFit(T, covariance, share, has_converged)


def _distances(
    points_lidar: Float, planes: PlaneMap, T: Float, reach_m: float
) -> tuple[Float, Float]:
    """Return the distances' derivatives by a motion of the lidar (n, 6), and the distances (n,)."""
    points_map = transform(T, points_lidar)
    found, index = planes.nearest(points_map, reach_m)
    normals = planes.planes.normals[index]
    distances_m = np.einsum("ni,ni->n", points_map[found] - planes.planes.points[index], normals)
    is_same = np.abs(distances_m) < _GATE * reach_m
    normals_lidar = normals[is_same] @ T[:3, :3]
    J = np.hstack([np.cross(points_lidar[found][is_same], normals_lidar), normals_lidar])
    return J, distances_m[is_same]


def _held(information: Float, points_lidar: Float, weight: float) -> Float:
    """Return the projection on the directions that the scene constrains, shape (6, 6).

    Noise tilts the normals of level ground, so that they seem to constrain every direction a
    little. Without the projection they move the scan along the ground and make the covariance too
    small (after Zhang 2016, "On degeneracy of optimization-based state estimation problems"; the
    threshold here is on the mean squared cosine, which does not grow with the number of points).
    """
    length_m = float(np.linalg.norm(points_lidar, axis=1).mean())
    # Rotations are weighted by the motion that they cause at the mean distance.
    scale = np.diag([1 / length_m] * 3 + [1.0] * 3)
    values, vectors = np.linalg.eigh(scale @ information @ scale / max(weight, 1e-9))
    kept = vectors[:, values > _LEAST_SQUARED_COSINE]
    return np.asarray(np.linalg.inv(scale) @ kept @ kept.T @ scale)
