"""Shortest curves of arcs and straight lines between two poses (Dubins 1957)."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from executive.arrays import Float

Lengths = tuple[float, float, float]
_NOTHING_M = 1e-9  # shorter pieces are left out


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Three pieces of one radius, each an arc to the left, to the right, or a straight line.

    Attributes:
        start: x [m], y [m] and heading [rad], shape (3,).
        radius_m: Radius of the arcs.
        turns: 1 (left), −1 (right) or 0 (straight) of each piece.
        lengths: Length of each piece over the radius; that of an arc is its angle [rad].
    """

    start: Float
    radius_m: float
    turns: tuple[int, int, int]
    lengths: Lengths

    @property
    def length_m(self) -> float:
        """Length of the curve [m]."""
        return self.radius_m * sum(self.lengths)

    def sampled(self, step_m: float) -> tuple[Float, Float]:
        """Return poses at most `step_m` apart (n, 3), and the curvature at each [1/m] (n,)."""
        begin = self.start
        poses, curvatures = [begin[None]], []
        for turn, length in zip(self.turns, self.lengths, strict=True):
            way_m = length * self.radius_m
            if way_m < _NOTHING_M:
                continue
            ways = np.linspace(0.0, way_m, max(2, int(np.ceil(way_m / step_m)) + 1))[1:]
            piece = along_arc(begin, turn / self.radius_m, ways)
            begin = piece[-1]
            poses.append(piece)
            curvatures += [turn / self.radius_m] * len(piece)
        first = curvatures[0] if curvatures else 0.0
        return np.concatenate(poses), np.array([first, *curvatures])


def along_arc(start: Float, curvature_1_m: float, ways_m: Float) -> Float:
    """Return the poses after ways [m] (n,) along an arc from a pose (3,), shape (n, 3)."""
    x, y, yaw = start
    turned = yaw + curvature_1_m * ways_m
    half = 0.5 * curvature_1_m * ways_m
    chord = ways_m * np.sinc(half / np.pi)  # 2/κ · sin(κs/2), and s on a straight line
    return np.column_stack([x + chord * np.cos(yaw + half), y + chord * np.sin(yaw + half), turned])


def curves(start: Float, goal: Float, radius_m: float) -> Iterator[Curve]:
    """Yield the curves from a pose (3,) to another that exist, the shortest first.

    Source: Shkel and Lumelsky 2001, Classification of the Dubins set, Sec. 2: the six words in
    coordinates with the goal on the x axis, lengths over the radius.
    """
    offset = goal[:2] - start[:2]
    towards = float(np.arctan2(offset[1], offset[0]))
    given = _Given(float(np.hypot(*offset)) / radius_m, start[2] - towards, goal[2] - towards)
    found = [(turns, word(given)) for turns, word in _WORDS.items()]
    possible = [Curve(start, radius_m, turns, one) for turns, one in found if one is not None]
    yield from sorted(possible, key=lambda curve: curve.length_m)


@dataclass(frozen=True, slots=True)
class _Given:
    """Distance over the radius, and the headings at start and goal [rad]."""

    d: float
    a: float
    b: float


def _lsl(g: _Given) -> Lengths | None:
    x = g.d + np.sin(g.a) - np.sin(g.b)
    y = np.cos(g.b) - np.cos(g.a)
    angle = np.arctan2(y, x)
    return _turn(angle - g.a), float(np.hypot(x, y)), _turn(g.b - angle)


def _rsr(g: _Given) -> Lengths | None:
    return _lsl(_mirrored(g))


def _lsr(g: _Given) -> Lengths | None:
    p2 = -2 + g.d**2 + 2 * np.cos(g.a - g.b) + 2 * g.d * (np.sin(g.a) + np.sin(g.b))
    if p2 < 0:
        return None
    p = float(np.sqrt(p2))
    angle = np.arctan2(-np.cos(g.a) - np.cos(g.b), g.d + np.sin(g.a) + np.sin(g.b))
    angle -= np.arctan2(-2.0, p)
    return _turn(angle - g.a), p, _turn(angle - g.b)


def _rsl(g: _Given) -> Lengths | None:
    return _lsr(_mirrored(g))


def _lrl(g: _Given) -> Lengths | None:
    cosine = (6 - g.d**2 + 2 * np.cos(g.a - g.b) + 2 * g.d * (np.sin(g.b) - np.sin(g.a))) / 8
    if abs(cosine) > 1:
        return None
    p = _turn(2 * np.pi - np.arccos(cosine))
    angle = np.arctan2(np.cos(g.a) - np.cos(g.b), g.d + np.sin(g.a) - np.sin(g.b))
    first = _turn(-g.a - angle + p / 2)
    return first, p, _turn(g.b - g.a - first + p)


def _rlr(g: _Given) -> Lengths | None:
    return _lrl(_mirrored(g))


def _mirrored(g: _Given) -> _Given:
    return _Given(g.d, -g.a, -g.b)


def _turn(angle_rad: float) -> float:
    """Return an angle in [0, 2π); a full turn by rounding is none."""
    turn = float(angle_rad % (2 * np.pi))
    return 0.0 if 2 * np.pi - turn < 1e-9 else turn


_WORDS: Mapping[tuple[int, int, int], Callable[[_Given], Lengths | None]] = {
    (1, 0, 1): _lsl,
    (-1, 0, -1): _rsr,
    (1, 0, -1): _lsr,
    (-1, 0, 1): _rsl,
    (1, -1, 1): _lrl,
    (-1, 1, -1): _rlr,
}
