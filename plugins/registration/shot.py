"""Unique signatures of histograms (Tombari et al. 2010): what a surface looks like from its own
frame of reference.
"""

import numpy as np
from executive_plugins.registration.eigen import sorted_eigenvectors
from numba import njit

from executive.arrays import Float, Int

_AZIMUTHS, _ELEVATIONS, _SHELLS, _COSINES = 8, 2, 2, 11
SHOT_LENGTH = _AZIMUTHS * _ELEVATIONS * _SHELLS * _COSINES  # 352


@njit(cache=True)  # type: ignore[untyped-decorator]
def shot_descriptors(
    points: Float, normals: Float, keypoints: Int, neighbours: tuple[Int, Int], radius_m: float
) -> tuple[Float, Float]:
    """Describe keypoints of one segment by the normals around them.

    Deviation from the source: the frame's z axis takes its sign from the outward normal, not from
    the majority of the points, which is a coin's throw on a convex stone.

    Args:
        points: Of one segment [m], shape (N, 3).
        normals: Outward, zero where unknown, shape (N, 3).
        keypoints: Rows of the points to describe, shape (K,).
        neighbours: Starts (K + 1,) and rows of the points within the radius of each keypoint.
        radius_m: R_shot [m].

    Returns:
        Unit descriptors, shape (K, 352), zero where too few points surround a keypoint, and frames,
        rows x, y and z, shape (K, 3, 3).
    """
    starts, rows = neighbours
    found, frames = np.zeros((len(keypoints), SHOT_LENGTH)), np.zeros((len(keypoints), 3, 3))
    for k in range(len(keypoints)):
        near = rows[starts[k] : starts[k + 1]]
        origin = points[keypoints[k]]
        if len(near) < 8:
            continue
        frame = reference_frame(points, near, origin, normals[keypoints[k]], radius_m)
        frames[k] = frame
        for j in near:
            dx, dy, dz = (
                points[j, 0] - origin[0],
                points[j, 1] - origin[1],
                points[j, 2] - origin[2],
            )
            distance = np.sqrt(dx * dx + dy * dy + dz * dz)
            nx, ny, nz = normals[j]
            if distance > 1e-9 * radius_m and (nx != 0 or ny != 0 or nz != 0):
                x = (frame[0, 0] * dx + frame[0, 1] * dy + frame[0, 2] * dz) / distance
                y = (frame[1, 0] * dx + frame[1, 1] * dy + frame[1, 2] * dz) / distance
                z = (frame[2, 0] * dx + frame[2, 1] * dy + frame[2, 2] * dz) / distance
                cosine = frame[2, 0] * nx + frame[2, 1] * ny + frame[2, 2] * nz
                _vote(found[k], (x, y, z), distance / radius_m, cosine)
        length = np.sqrt(found[k] @ found[k])
        if length > 0:
            found[k] /= length
    return found, frames


@njit(cache=True)  # type: ignore[untyped-decorator]
def reference_frame(
    points: Float, near: Int, origin: Float, outward: Float, radius_m: float
) -> Float:
    """Return a repeatable frame at a keypoint, rows x, y and z, from points weighted by their
    nearness (Eq. 1).
    """
    scatter = np.zeros((3, 3))
    for j in near:
        dx, dy, dz = points[j, 0] - origin[0], points[j, 1] - origin[1], points[j, 2] - origin[2]
        weight = radius_m - np.sqrt(dx * dx + dy * dy + dz * dz)
        scatter[0, 0] += weight * dx * dx
        scatter[0, 1] += weight * dx * dy
        scatter[0, 2] += weight * dx * dz
        scatter[1, 1] += weight * dy * dy
        scatter[1, 2] += weight * dy * dz
        scatter[2, 2] += weight * dz * dz
    scatter[1, 0], scatter[2, 0], scatter[2, 1] = scatter[0, 1], scatter[0, 2], scatter[1, 2]
    axes = sorted_eigenvectors(scatter)[1]
    x, z = axes[0], axes[2]
    ahead = 0
    for j in near:
        along = (
            (points[j, 0] - origin[0]) * x[0]
            + (points[j, 1] - origin[1]) * x[1]
            + (points[j, 2] - origin[2]) * x[2]
        )
        ahead += 1 if along >= 0 else -1
    x = x if ahead >= 0 else -x
    z = z if outward @ z >= 0 else -z
    return np.vstack((x, np.cross(z, x), z)).reshape(3, 3)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _vote(
    histogram: Float, direction: tuple[float, float, float], share: float, cosine: float
) -> None:
    """Spread one neighbour over the two nearest bins of each of the four coordinates."""
    azimuth = (np.arctan2(direction[1], direction[0]) / (2 * np.pi) + 0.5) * _AZIMUTHS - 0.5
    height = min(max(direction[2], -1.0), 1.0)
    elevation = min(
        max((np.arcsin(height) / np.pi + 0.5) * _ELEVATIONS - 0.5, 0.0), _ELEVATIONS - 1.0
    )
    shell = min(max(share * _SHELLS - 0.5, 0.0), _SHELLS - 1.0)
    tilt = min(max((cosine + 1) / 2 * _COSINES - 0.5, 0.0), _COSINES - 1.0)
    a, e, s, c = int(np.floor(azimuth)), int(elevation), int(shell), int(tilt)
    fa, fe, fs, fc = azimuth - a, elevation - e, shell - s, tilt - c
    for da in range(2):
        wa = fa if da else 1 - fa
        row_a = (a + da) % _AZIMUTHS
        for de in range(2 if fe > 0 else 1):
            we = wa * (fe if de else 1 - fe)
            for ds in range(2 if fs > 0 else 1):
                ws = we * (fs if ds else 1 - fs)
                base = ((row_a * _ELEVATIONS + e + de) * _SHELLS + s + ds) * _COSINES + c
                histogram[base] += ws * (1 - fc)
                if fc > 0:
                    histogram[base + 1] += ws * fc
