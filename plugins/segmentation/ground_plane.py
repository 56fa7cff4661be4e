"""The plane that carries most of a cloud: random sample consensus, then refits (Mascaro 2020, Sec.
4.3).
"""

import numpy as np
from executive_plugins.segmentation.shape import counts_near, moments, planes_through
from numba import njit

from executive.arrays import Float
from executive.errors import DataError

_SUBSAMPLE = 2000  # points that vote: 0.2 % resolution of the inlier share
_HYPOTHESES = 160  # with half of the points on the ground, all miss it once in 10⁹ clouds
_REFITS = 4


def fit_plane(points: Float) -> Float:
    """Return the least-squares plane (n, d) with n·p = d and n_z ≥ 0, shape (N, 3) → (4,)."""
    mean, scatter = moments(points)
    normal = np.linalg.eigh(scatter)[1][:, 0]
    normal = -normal if normal[2] < 0 else normal
    return np.array([*normal, normal @ mean])


def plane_heights(points: Float, plane: Float) -> Float:
    """Return signed distances above a plane [m], shape (N,)."""
    return np.asarray(points @ plane[:3] - plane[3])


def fit_ground_plane(
    points: Float, margin_m: float, max_tilt_rad: float, rng: np.random.Generator
) -> Float:
    """Find the ground's mean plane.

    Args:
        points: In a frame whose z axis is roughly up [m], shape (N, 3).
        margin_m: Undulation that still counts as the plane, d_plane [m].
        max_tilt_rad: Largest angle between the normal and z [rad].
        rng: The only source of chance.

    Returns:
        Unit normal pointing up, and offset d with n·p = d, shape (4,).

    Raises:
        DataError: If no plane within the tilt is carried by the points.
    """
    sample = (
        points[rng.permutation(len(points))[:_SUBSAMPLE]] if len(points) > _SUBSAMPLE else points
    )
    planes = planes_through(sample, rng.integers(len(sample), size=(3, _HYPOTHESES)))
    planes = planes[planes[:, 2] >= np.cos(max_tilt_rad)]
    if not len(planes):
        raise DataError(
            f"no ground in a cloud of {len(points)} points: no plane within "
            f"{np.degrees(max_tilt_rad):.0f}° of horizontal; is z up, and is the ground in view?"
        )
    plane = planes[np.argmax(counts_near(sample, planes, margin_m))]
    for _ in range(_REFITS):
        near = _near(points, plane, margin_m)
        refit = fit_plane(near) if len(near) >= 3 else plane
        plane = refit if refit[2] >= np.cos(max_tilt_rad) else plane
    return np.asarray(plane)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _near(points: Float, plane: Float, margin_m: float) -> Float:
    """Return the points within a margin of a plane, shape (M, 3)."""
    found, count = np.empty_like(points), 0
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        if abs(x * plane[0] + y * plane[1] + z * plane[2] - plane[3]) < margin_m:
            found[count, 0], found[count, 1], found[count, 2] = x, y, z
            count += 1
    return found[:count]
