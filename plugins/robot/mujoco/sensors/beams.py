"""Compiled loops over the beams of a lidar: into the world, towards moving objects, to points."""

import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import Rays
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int


def compile_beams() -> None:
    """Compile the loops, so that no scan waits for them."""
    box, none = np.zeros((1, 3), dtype=np.float32), np.zeros(1, dtype=np.int64)
    strided = np.zeros((2, 2, 6), dtype=np.float32)[:, :, ::2]  # in memory like those of a pattern
    beams_in_world(strided, none, np.zeros((2, 3)), np.zeros((2, 3, 3)))
    beams_towards(box.T.copy(), box, box)
    returned_points(strided, none, np.zeros(1))


@njit(cache=True)  # type: ignore[untyped-decorator]
def beams_in_world(
    directions: Rays, which: Int, origins: Float, rotations: Float
) -> Rays:  # pragma: no cover - compiled
    """Return origin and direction in the world of some beams of a revolution, shape (M, 6).

    A sum is rounded after each of its terms, as in a matrix product of single precision.

    Args:
        directions: In the lidar frame, shape (columns, lasers, 3).
        which: Indices of the beams, column by column, shape (M,).
        origins: Position of the lidar at each column [m], shape (columns, 3).
        rotations: R_world_lidar at each column, shape (columns, 3, 3).
    """
    lasers = directions.shape[1]
    rays = np.empty((len(which), 6), dtype=np.float32)
    R = np.empty((3, 3))
    last = -1
    for n in range(len(which)):
        column = which[n] // lasers
        if column != last:
            last = column
            for i in range(3):
                for k in range(3):
                    R[i, k] = np.float32(rotations[column, i, k])
        laser = which[n] - column * lasers
        x = np.float64(directions[column, laser, 0])
        y = np.float64(directions[column, laser, 1])
        z = np.float64(directions[column, laser, 2])
        for i in range(3):
            rays[n, i] = origins[column, i]
            along = np.float32(x * R[i, 0])
            along = np.float32(y * R[i, 1] + np.float64(along))
            rays[n, 3 + i] = np.float32(z * R[i, 2] + np.float64(along))
    return rays


@njit(cache=True)  # type: ignore[untyped-decorator]
def beams_towards(
    inverse: Rays, low: Rays, high: Rays
) -> NDArray[np.bool_]:  # pragma: no cover - compiled
    """Return which rays from the origin pass through a box, shape (N,).

    Args:
        inverse: One over each part of their directions, finite, shape (3, N).
        low: Lowest corner of each box [m], shape (B, 3).
        high: Its highest corner [m], shape (B, 3).
    """
    x, y, z = inverse[0], inverse[1], inverse[2]
    do_pass = np.zeros(len(x), dtype=np.bool_)
    for box in range(len(low)):
        low_x, low_y, low_z = low[box, 0], low[box, 1], low[box, 2]
        high_x, high_y, high_z = high[box, 0], high[box, 1], high[box, 2]
        for n in range(len(x)):  # without a branch, so that one instruction takes several rays
            in_x, out_x = min(low_x * x[n], high_x * x[n]), max(low_x * x[n], high_x * x[n])
            in_y, out_y = min(low_y * y[n], high_y * y[n]), max(low_y * y[n], high_y * y[n])
            in_z, out_z = min(low_z * z[n], high_z * z[n]), max(low_z * z[n], high_z * z[n])
            enters = max(max(in_x, in_y), max(in_z, np.float32(0.0)))
            do_pass[n] |= enters <= min(min(out_x, out_y), out_z)
    return do_pass


@njit(cache=True)  # type: ignore[untyped-decorator]
def returned_points(
    directions: Rays, which: Int, ranges: Float
) -> Float:  # pragma: no cover - compiled
    """Return the points of some beams in the lidar frame [m], shape (M, 3).

    Args:
        directions: In the lidar frame, shape (columns, lasers, 3).
        which: Indices of the beams, column by column, shape (M,).
        ranges: Their ranges [m], shape (M,).
    """
    lasers = directions.shape[1]
    points = np.empty((len(which), 3))
    for n in range(len(which)):
        column, laser = which[n] // lasers, which[n] % lasers
        for i in range(3):
            points[n, i] = np.float64(directions[column, laser, i]) * ranges[n]
    return points
