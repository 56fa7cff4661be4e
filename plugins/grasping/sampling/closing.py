"""The push along each approach, and the closing of the jaws at its end.

The loops are compiled, single-threaded and deterministic: thousands of hypotheses per second over
some ten thousand points.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from executive_plugins.grasping.sampling.jaw_field import NEVER, JawField
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Bool, Float

_ROUNDS = 6  # depth and closing depend on each other and converge in two or three rounds
_TOUCH = 1  # steps of progress past the first touch that still count as contact
_FIRST = 3  # number of points that make a touch; fewer may be noise


class HoldOutcome(IntEnum):
    """Result of a hypothesis; the names are the reasons of refusal."""

    HELD = 0
    NOTHING_TOUCHED = 1  # the open gripper passes beside the stone and the ground
    NOTHING_BETWEEN_JAWS = 2
    ONE_JAW_ONLY = 3
    JAWS_SWEEP_BLOCKED = 4  # a neighbour or the ground is where the jaws close, at all depths
    TIPS_TOO_HIGH = 5  # the tips stay above the centre of the stone and would slip off


@dataclass(frozen=True, slots=True, eq=False)
class Hypotheses:
    """Approaches to try.

    Attributes:
        R: Orientations of the gripper, columns approach, opening, width, shape (M, 3, 3).
        anchor: A point on the line of each approach [m], shape (M, 3).
        is_centred: Whether to move the line to the middle of the stone between the jaws, shape
            (M,).
    """

    R: Float
    anchor: Float
    is_centred: Bool

    def followed_by(self, other: "Hypotheses") -> "Hypotheses":
        """Return these approaches, then others."""
        return Hypotheses(
            np.concatenate([self.R, other.R]),
            np.concatenate([self.anchor, other.anchor]),
            np.concatenate([self.is_centred, other.is_centred]),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Clearance:
    """Clearances that are kept at the end of the push [m]."""

    stone_m: float
    other_m: float
    tips_below_centre_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Holds:
    """Results of all hypotheses.

    Attributes:
        outcome: A `HoldOutcome`, shape (M,).
        position: Origin of the gripper at the end of the push [m], shape (M, 3).
        progress: Progress at which the left and the right jaw touch the stone, shape (M, 2).
        contact: Mean of the stone's points at the left and the right jaw, in the gripper frame [m],
            shape (M, 2, 3).
        contacts: Number of those points, shape (M, 2).
    """

    outcome: NDArray[np.int64]
    position: Float
    progress: NDArray[np.int64]
    contact: Float
    contacts: NDArray[np.int64]


def push_and_close(
    field: JawField,
    points: Float,
    is_target: Bool,
    centre: Float,
    tried: Hypotheses,
    clearance: Clearance,
) -> Holds:
    """Push every hypothesis until the open gripper touches, then close the jaws on the stone.

    Where the closing jaws would hit something else, the gripper is withdrawn.

    Args:
        field: Tables of the gripper.
        points: The planning cloud [m], shape (N, 3).
        is_target: Mask of the stone's points, shape (N,).
        centre: Estimated centre of mass of the stone [m], shape (3,).
        tried: The hypotheses.
        clearance: Clearances to keep.
    """
    m = len(tried.R)
    holds = Holds(
        outcome=np.zeros(m, dtype=np.int64),
        position=np.zeros((m, 3)),
        progress=np.full((m, 2), NEVER, dtype=np.int64),
        contact=np.zeros((m, 2, 3)),
        contacts=np.zeros((m, 2), dtype=np.int64),
    )
    order = np.argsort(~is_target, kind="stable")  # the loops expect the points of the stone first
    tables = (field.front, field.sweep, field.tip_a, np.array(field.origin), field.cell_m)
    room = np.array(
        [clearance.stone_m, clearance.other_m, clearance.tips_below_centre_m], dtype=float
    )
    _try_all(
        np.ascontiguousarray(points[order]),
        int(is_target.sum()),
        np.asarray(centre, dtype=float),
        (
            np.ascontiguousarray(tried.R.transpose(0, 2, 1)),
            np.ascontiguousarray(tried.anchor),
            np.asarray(tried.is_centred),
        ),
        tables,
        room,
        (holds.outcome, holds.position, holds.progress, holds.contact, holds.contacts),
    )
    return holds


@njit(cache=True)
def _try_all(points, targets, centre, tried, tables, room, out):  # type: ignore[no-untyped-def]  # compiled
    axes, anchor, is_centred = tried  # axes: approach, opening, width as rows
    outcome, position, progress, contact, contacts = out
    near = np.empty((len(points), 3))
    for i in range(len(axes)):
        line = anchor[i].copy()
        if is_centred[i]:
            line += _to_middle(points[:targets], axes[i], line, tables) * axes[i, 1]
        n_target, n = _gather(points, targets, axes[i], line, tables, near)
        centre_a = (centre - line) @ axes[i, 0]
        outcome[i], depth = _settle(near, n_target, n, centre_a, tables, room, progress[i])
        position[i] = line + depth * axes[i, 0]
        if outcome[i] == HoldOutcome.HELD:
            _touch(near[:n_target], depth, tables, progress[i], contact[i], contacts[i])


@njit(cache=True)
def _gather(points, targets, axes, line, tables, near):  # type: ignore[no-untyped-def]  # compiled
    """Fill `near` with the points in the columns of the gripper, those of the target first.

    The coordinates are those of the gripper's axes, from the anchor of the line.
    """
    front, origin, cell = tables[0], tables[3], tables[4]
    n, n_target = 0, 0
    for j in range(len(points)):
        x, y, z = points[j, 0] - line[0], points[j, 1] - line[1], points[j, 2] - line[2]
        c = x * axes[2, 0] + y * axes[2, 1] + z * axes[2, 2]
        ic = int(np.floor((c - origin[2]) / cell))
        if ic < 0 or ic >= front.shape[2]:
            continue
        b = x * axes[1, 0] + y * axes[1, 1] + z * axes[1, 2]
        ib = int(np.floor((b - origin[1]) / cell))
        if ib < 0 or ib >= front.shape[1]:
            continue
        near[n, 0] = x * axes[0, 0] + y * axes[0, 1] + z * axes[0, 2]
        near[n, 1] = b
        near[n, 2] = c
        n += 1
        if j < targets:
            n_target = n
    return n_target, n


@njit(cache=True)
def _settle(near, n_target, n, centre_a, tables, room, progress):  # type: ignore[no-untyped-def]  # compiled
    """Return outcome and depth: push, close, and withdraw until nothing blocks the closing."""
    front, sweep, tip_a = tables[0], tables[1], tables[2]
    free = min(
        _free_depth(near[:n_target], front[0], tables) - room[0],
        _free_depth(near[n_target:n], front[0], tables) - room[1],
    )
    if free > 1e2:
        return HoldOutcome.NOTHING_TOUCHED, 0.0
    for _ in range(_ROUNDS):
        depth = free
        for side in range(2):
            progress[side] = _first_touch(near[:n_target], depth, sweep[side], tables)
        if progress[0] == NEVER and progress[1] == NEVER:
            return HoldOutcome.NOTHING_BETWEEN_JAWS, depth
        if progress[0] == NEVER or progress[1] == NEVER:
            return HoldOutcome.ONE_JAW_ONLY, depth
        last = max(progress[0], progress[1])
        if depth + tip_a[last] < centre_a + room[2]:
            return HoldOutcome.TIPS_TOO_HIGH, depth
        free = min(depth, _free_depth(near[n_target:n], front[last], tables) - room[1])
        if free >= depth - 0.03 * tables[4]:  # less than the resolution of the tables
            return HoldOutcome.HELD, depth
    return HoldOutcome.JAWS_SWEEP_BLOCKED, depth


@njit(cache=True)
def _free_depth(near, height, tables):  # type: ignore[no-untyped-def]  # compiled
    """Return the depth at which a front touches the first point: the least a − H(b, c)."""
    origin, cell = tables[3], tables[4]
    least = 1e3
    for j in range(len(near)):
        ib = int(np.floor((near[j, 1] - origin[1]) / cell))
        ic = int(np.floor((near[j, 2] - origin[2]) / cell))
        least = min(least, near[j, 0] - height[ib, ic])
    return least


@njit(cache=True)
def _first_touch(near, depth, sweep, tables):  # type: ignore[no-untyped-def]  # compiled
    """Return the progress at which a jaw has touched a few points, or NEVER."""
    first = np.full(_FIRST, NEVER, dtype=np.int64)
    for j in range(len(near)):
        k = np.int64(_swept(near[j], depth, sweep, tables))
        for i in range(_FIRST):
            if k < first[i]:
                k, first[i] = first[i], k
    return first[_FIRST - 1]


@njit(cache=True)
def _swept(point, depth, sweep, tables):  # type: ignore[no-untyped-def]  # compiled
    origin, cell = tables[3], tables[4]
    ia = int(np.floor((point[0] - depth - origin[0]) / cell))
    ib = int(np.floor((point[1] - origin[1]) / cell))
    ic = int(np.floor((point[2] - origin[2]) / cell))
    if ia < 0 or ia >= sweep.shape[0]:
        return NEVER
    return sweep[ia, ib, ic]


@njit(cache=True)
def _touch(near, depth, tables, progress, contact, contacts):  # type: ignore[no-untyped-def]  # compiled
    """Compute the mean and the number of the points that each jaw touches."""
    for j in range(len(near)):
        for side in range(2):
            if _swept(near[j], depth, tables[1][side], tables) <= progress[side] + _TOUCH:
                contacts[side] += 1
                contact[side] += near[j]
    for side in range(2):
        contact[side] /= contacts[side]
        contact[side, 0] -= depth


@njit(cache=True)
def _to_middle(points, axes, line, tables):  # type: ignore[no-untyped-def]  # compiled
    """Return the offset along the opening to the middle of the stone [m].

    Only the part of the stone within the width of the gripper counts.
    """
    origin, cell = tables[3], tables[4]
    half = -origin[2] - 2 * cell
    low, high = 1e3, -1e3
    for j in range(len(points)):
        v = points[j] - line
        if abs(v @ axes[2]) <= half:
            b = v @ axes[1]
            low, high = min(low, b), max(high, b)
    return 0.0 if low > high else (low + high) / 2
