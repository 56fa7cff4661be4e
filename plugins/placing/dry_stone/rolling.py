"""A stone rolls on height maps: about the point that it touches, as long as that lowers it.

Friction holds the point where a stone touches; the stone tilts about it until it touches elsewhere,
and then about that point. Its centre of mass so moves sideways as well as down. A stone that only
sinks over a fixed point is told too level: of 794 places at which it tilted by more than 6°, slid
or toppled in physics, rolling tells 77 % by a tilt of 6.5°, sinking 39 %, and neither tells one
of 105 places at which the stone held (walls of 62401, 62403 and 62414, see docs/evidence/walls.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.placing.dry_stone.rasters import StoneRaster, WallTop
from numba import njit

from executive.arrays import Float

STEPS_RAD = (0.04, 0.02, 0.01)  # the last one shifts the rim of a stone of 1 m by 5 mm
_LOWER_M = 1e-4  # a step that lowers the stone by less changes nothing
_WAYS = 8  # in which it may tilt at each step
_MOST_STEPS = 40  # of one size


@dataclass(frozen=True, slots=True, eq=False)
class Rolled:
    """Where a stone has rolled to.

    Attributes:
        tilt: Rotation vector from the attitude in which its underside was taken, its horizontal
            part, shape (2,) [rad].
        xy: Where its origin is then, shape (2,) [m].
        height_m: Height of its origin [m].
        is_at_rest: Whether nothing lowers it there; otherwise it has tilted too far.
    """

    tilt: Float
    xy: Float
    height_m: float
    is_at_rest: bool


def underside_of(stone: StoneRaster, cell_m: float) -> Float:
    """Return the nodes of a stone's underside from its origin, shape (N, 3) [m]."""
    i, j = np.nonzero(np.isfinite(stone.under))
    return np.ascontiguousarray(
        np.column_stack([
            (i + stone.first[0]) * cell_m, (j + stone.first[1]) * cell_m, stone.under[i, j]
        ])
    )  # fmt: skip


def roll(
    underside: Float,
    wall: WallTop,
    xy: Float,
    tilt: Float,
    most_rad: float,
    steps_rad: Sequence[float] = STEPS_RAD,
) -> Rolled:
    """Return where a stone comes to rest that first touches over a point.

    Args:
        underside: Points of its underside from its origin, shape (N, 3) [m].
        wall: What it rests on.
        xy: Where its origin is, shape (2,) [m].
        tilt: How it is let go: horizontal part of the rotation vector, shape (2,) [rad].
        most_rad: Tilt from which on it is lost.
        steps_rad: Steps of the tilt, the last one is how exact the rest is.
    """
    found = np.zeros(6)
    corner = wall.corner * wall.cell_m
    _roll(
        underside, wall.top, corner, wall.cell_m, np.array([*tilt, *xy], dtype=np.float64),
        most_rad, np.array(steps_rad), found,
    )  # fmt: skip
    return Rolled(found[:2], found[2:4], float(found[4]), bool(found[5]))


def compile_rolling() -> None:
    """Compile the inner loops, so that no search has to wait for them."""
    start, steps = np.array([0.0, 0.0, 1.0, 1.0]), np.array(STEPS_RAD)
    _roll(np.zeros((1, 3)), np.zeros((4, 4)), np.zeros(2), 1.0, start, 0.5, steps, np.zeros(6))


@njit(cache=True)
def _roll(points, top, corner, cell, start, most, steps, found):  # type: ignore[no-untyped-def]  # noqa: PLR0913 - compiled: no classes
    """Write tilt (2), place (2), height and whether it rests into `found`."""
    here, touch, tried, other = start.copy(), np.zeros(3), np.zeros(4), np.zeros(3)
    best, z = here.copy(), _height(points, top, corner, cell, here, touch)
    found[5] = 1.0
    for step in steps:
        for _ in range(_MOST_STEPS):
            lowest = z - _LOWER_M
            best[:] = here
            for way in range(_WAYS):
                angle = 2 * np.pi * way / _WAYS
                tried[0] = here[0] + step * np.cos(angle)
                tried[1] = here[1] + step * np.sin(angle)
                x, y, _z = _turned(points[int(touch[0])], tried[0], tried[1])
                tried[2], tried[3] = here[2] + touch[1] - x, here[3] + touch[2] - y
                height = _height(points, top, corner, cell, tried, other)
                if height < lowest:
                    lowest, best[:] = height, tried
            if lowest == z - _LOWER_M:
                break
            here[:] = best
            z = _height(points, top, corner, cell, here, touch)
            if here[0] ** 2 + here[1] ** 2 > most**2:
                found[5] = 0.0
                break
        if found[5] == 0.0:
            break
    found[:4], found[4] = here, z


@njit(cache=True)
def _turned(point, a, b):  # type: ignore[no-untyped-def]
    """Return a point rotated about the horizontal axis (a, b), to the second order."""
    x, y, z = point
    along, square = a * x + b * y, a * a + b * b
    return (
        x + b * z + 0.5 * (a * along - square * x),
        y - a * z + 0.5 * (b * along - square * y),
        z + a * y - b * x - 0.5 * square * z,
    )


@njit(cache=True)
def _height(points, top, corner, cell, at, touch):  # type: ignore[no-untyped-def]
    """Return the height of the origin where the stone first touches; and by which point, where."""
    highest = -np.inf
    for n in range(len(points)):
        x, y, z = _turned(points[n], at[0], at[1])
        u, v = (x + at[2] - corner[0]) / cell, (y + at[3] - corner[1]) / cell
        i, j = int(np.floor(u)), int(np.floor(v))
        if i < 0 or j < 0 or i >= top.shape[0] - 1 or j >= top.shape[1] - 1:
            continue
        u, v = u - i, v - j
        below = (top[i, j] * (1 - u) + top[i + 1, j] * u) * (1 - v)
        below += (top[i, j + 1] * (1 - u) + top[i + 1, j + 1] * u) * v
        if below - z > highest:
            highest = below - z
            touch[0], touch[1], touch[2] = n, x, y
    return highest
