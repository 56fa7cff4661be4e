"""One row of equally spaced places on an arc around the machine."""

from collections.abc import Callable

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import yaw_of

_PHASES = 12  # number of shifts of the row along its arc


def spaced_row(
    radius_m: float,
    spacing_m: float,
    sector_rad: float,
    T_map_base: Float,
    height_of: Callable[[Float], float | None],
) -> Float:
    """Return the row with the most usable places, those nearest the front first, shape (n, 3).

    Args:
        radius_m: Radius of the arc around the base [m].
        spacing_m: Chord between neighbours [m].
        sector_rad: Angle of the arc, half of it to either side of the front [rad].
        T_map_base: Pose of the chassis, shape (4, 4).
        height_of: Returns the ground height [m] at a place (2,), None where no slot is possible.
    """
    step = 2 * np.arcsin(min(spacing_m / (2 * radius_m), 1.0))
    whole = int(sector_rad // step)
    if whole and sector_rad > 2 * np.pi - step:  # a full ring: make the last gap like the others
        step = max(step, sector_rad / whole)
    best = np.empty((0, 3))
    for phase in np.arange(_PHASES) / _PHASES * step:
        angles = np.arange(
            -sector_rad / 2 + phase, sector_rad / 2 - (step - 1e-9 if whole else 0), step
        )
        row = _usable(
            angles[np.argsort(np.abs(angles), kind="stable")], radius_m, T_map_base, height_of
        )
        best = row if len(row) > len(best) else best
    return best


def _usable(
    angles: Float, radius_m: float, T_map_base: Float, height_of: Callable[[Float], float | None]
) -> Float:
    front = yaw_of(T_map_base[:3, :3])
    places = T_map_base[:2, 3] + radius_m * np.column_stack(
        [np.cos(front + angles), np.sin(front + angles)]
    )
    heights = [height_of(place) for place in places]
    return np.array(
        [[*xy, z] for xy, z in zip(places, heights, strict=True) if z is not None]
    ).reshape(-1, 3)
