"""Motion correction: each return of a scan at its own time (Mascaro 2020, Sec. 4.2, step 2)."""

import numpy as np
from numba import njit

from executive.arrays import Float, Int
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion


@njit(cache=True)  # type: ignore[untyped-decorator]
def place(points: Float, slices: Int, fractions: Float, poses: Float) -> Float:
    """Transform each point by the pose at its time, interpolated between its slice's ends.

    The matrices are interpolated linearly: at 10°/s, a slice of 10 ms and a distance of 10 m, the
    error is 4 µm.
    """  # pragma: no cover - compiled
    placed = np.empty_like(points)
    for n in range(len(points)):
        a, b, f = poses[slices[n]], poses[slices[n] + 1], fractions[n]
        for row in range(3):
            total = 0.0
            for column in range(3):
                total += ((1 - f) * a[row, column] + f * b[row, column]) * points[n, column]
            placed[n, row] = total + (1 - f) * a[row, 3] + f * b[row, 3]
    return placed


def time_slices(scan: LidarScan, slice_s: float) -> tuple[Float, Int, Float]:
    """Divide a scan's time into equal slices.

    Returns:
        Ends of the slices [s], shape (k + 1,), and for each point its slice and its fraction of it,
        shapes (N,).
    """
    first_s, last_s = float(scan.point_stamps_s[0]), float(scan.point_stamps_s[-1])
    count = max(1, int(np.ceil((last_s - first_s) / slice_s)))
    ends_s = np.linspace(first_s, last_s, count + 1)
    position = (scan.point_stamps_s - first_s) * (
        count / (last_s - first_s) if last_s > first_s else 0.0
    )
    slices = np.minimum(position.astype(np.int64), count - 1)
    return ends_s, slices, position - slices


def cabin_poses(motion: Motion, stamps_s: Float) -> Float:
    """Return T_map_cabin at each time, shape (k, 4, 4)."""
    return np.array([motion.T_map_cabin_at(float(stamp)) for stamp in stamps_s])
