"""The nearest return of a scan in each direction, to tell what two rays pass on either side.

The rings of a lidar are some degrees apart, so that most places of a surface that has left are
passed by no ray closely. Where the rays on either side of such a place, no farther apart than the
smallest thing to be kept, both end well behind it, and no return about it is nearer, nothing of
that size is there: it would have stopped one of them.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from executive.arrays import Bool, Float

_STEP_RAD = np.radians(0.5)  # edge of a direction: wider than the columns of a lidar are apart
_ACROSS, _UP = 720, 360  # directions about the vertical, and from straight down to straight up

_BLOCK = 8  # directions along the edge of a block

_STOPPED, _UNKNOWN, _SEEN_THROUGH = -1, 0, 1  # what the rays about a place tell of it


class RangeImage(NamedTuple):
    """What a lidar saw in each direction.

    Attributes:
        nearest: Range of the nearest return [m], inf without one, shape (720, 360).
        is_about: Whether there is a return in a block of directions or one beside it, (90, 45).
    """

    nearest: Float
    is_about: Bool


@njit(cache=True)  # type: ignore[untyped-decorator]
def nearest_returns(origin: Float, points: Float) -> RangeImage:  # pragma: no cover - compiled
    """Return the nearest return in each direction.

    Args:
        origin: Position of the lidar [m], shape (3,).
        points: Its returns in the same frame [m], shape (N, 3).
    """
    nearest = np.full((_ACROSS, _UP), np.inf)
    for n in range(len(points)):
        x, y, z = points[n, 0] - origin[0], points[n, 1] - origin[1], points[n, 2] - origin[2]
        across, up, range_m = _direction(x, y, z)
        nearest[across, up] = min(nearest[across, up], range_m)
    return RangeImage(nearest, _blocks_about(nearest))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _blocks_about(nearest: Float) -> Bool:  # pragma: no cover - compiled
    blocks_across, blocks_up = _ACROSS // _BLOCK, _UP // _BLOCK
    is_about = np.zeros((blocks_across, blocks_up), dtype=np.bool_)
    for i in range(blocks_across):
        for j in range(blocks_up):
            across, up = i * _BLOCK, j * _BLOCK
            if np.isfinite(nearest[across : across + _BLOCK, up : up + _BLOCK].min()):
                for k in range(-1, 2):
                    is_about[(i + k) % blocks_across, max(j - 1, 0) : j + 2] = True
    return is_about


@njit(cache=True)  # type: ignore[untyped-decorator]
def passed_on_both_sides(
    image: RangeImage, origin: Float, place: Float, width_m: float, margin_m: float
) -> bool:  # pragma: no cover - compiled
    """Return whether rays at most a width apart pass a place above and below, or left and right,
    and none in the other direction ends before it.

    Args:
        image: What `nearest_returns` found.
        origin: Position of the lidar [m], shape (3,).
        place: The place in the same frame [m], shape (3,).
        width_m: Largest distance of the two rays, at the place [m].
        margin_m: Distance behind the place at which they end at least [m].
    """
    x, y, z = place[0] - origin[0], place[1] - origin[1], place[2] - origin[2]
    across, up, range_m = _direction(x, y, z)
    least_m = range_m + margin_m
    most = int(width_m / (range_m * _STEP_RAD)) + 1
    # Few directions have returns about them: a lidar looks no more than some degrees up and down.
    if most <= _BLOCK and not image.is_about[across // _BLOCK, up // _BLOCK]:
        return False
    nearest = image.nearest
    upright = _passed(nearest, across, up, 0, 1, most, least_m)
    if upright == _STOPPED:
        return False
    level = _passed(nearest, across, up, 1, 0, most, least_m)
    return bool(min(upright, level) >= _UNKNOWN and max(upright, level) == _SEEN_THROUGH)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _passed(
    nearest: Float, across: int, up: int, along: int, aside: int, most: int, least_m: float
) -> int:  # pragma: no cover - compiled
    """Look both ways for the next directions with a return; three abreast are one.

    A ray through the direction itself parts what is between the two others.
    """
    own_m = _abreast(nearest, across, up, along, aside)
    if own_m <= least_m:
        return _STOPPED
    apart, sides = 0, 0
    for way in (-1, 1):
        for steps in range(1, most + 1 - apart):
            range_m = _abreast(
                nearest, across + way * steps * along, up + way * steps * aside, along, aside
            )
            if range_m <= least_m:
                return _STOPPED
            if range_m < np.inf:
                apart = steps if own_m == np.inf else 0
                sides += 1
                break
    return _SEEN_THROUGH if sides == 2 else _UNKNOWN


@njit(cache=True)  # type: ignore[untyped-decorator]
def _abreast(
    nearest: Float, across: int, up: int, along: int, aside: int
) -> float:  # pragma: no cover - compiled
    least_m = np.inf
    for k in range(-1, 2):
        i, j = (across + k * aside) % _ACROSS, up + k * along
        if 0 <= j < _UP:
            least_m = min(least_m, nearest[i, j])
    return least_m


@njit(cache=True)  # type: ignore[untyped-decorator]
def _direction(
    x: float, y: float, z: float
) -> tuple[int, int, float]:  # pragma: no cover - compiled
    """Return the indices of a direction and the length of its vector [m].

    It takes numbers, because an array for each return or place took as long as all the rest.
    """
    flat_m = np.sqrt(x**2 + y**2)
    across = int((np.arctan2(y, x) + np.pi) / _STEP_RAD)
    up = int((np.arctan2(z, flat_m) + 0.5 * np.pi) / _STEP_RAD)
    range_m = np.sqrt(flat_m**2 + z**2)
    return min(across, _ACROSS - 1), min(up, _UP - 1), range_m
