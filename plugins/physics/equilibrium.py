"""Static equilibrium of rigid stones with friction, as a linear program.

Forces at the contacts must balance weight and a horizontal load on every free stone, within
friction pyramids. The load is a share of the weight in one direction, as on a tilted floor or in a
slow earthquake. The largest share that can be balanced is the margin; without any it is infeasible.
No simulator is needed: Livesley 1978; Whiting et al. 2009, Sec. 3; Nadeau and Kelly 2025 use the
same conditions for planning.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix

from executive.arrays import Float

_SIDES = 8  # of the pyramid in each friction cone, inscribed: it holds cos(22.5°) of the friction
_MOST = 2.0  # a load of twice the weight: the program needs a bound


@dataclass(frozen=True, slots=True, eq=False)
class Touch:
    """A point at which two bodies touch.

    Attributes:
        first: Number of one body; −1 is what cannot move.
        second: Number of the other, which is pushed along the normal.
        point: The place in the world [m], shape (3,).
        normal: Unit vector from the first to the second, shape (3,).
    """

    first: int
    second: int
    point: Float
    normal: Float


def largest_load(
    touches: Sequence[Touch],
    centres: Float,
    masses_kg: Float,
    friction: float,
    direction: Float,
) -> float | None:
    """Return the largest horizontal load, as a share of the weight, that all bodies can bear.

    Args:
        touches: Where they touch each other and what cannot move.
        centres: Centres of mass of the bodies, numbered from 0 [m], shape (B, 3).
        masses_kg: Their masses, shape (B,).
        friction: Coefficient of friction.
        direction: Horizontal unit vector of the load, shape (3,).

    Returns:
        The share, at most 2; None if they cannot even bear their weight. A load may also hold what
        would fall by itself: ask for it in directions all around.
    """
    return least_load(touches, centres, masses_kg, friction, direction[None])


def least_load(
    touches: Sequence[Touch],
    centres: Float,
    masses_kg: Float,
    friction: float,
    directions: Float,
) -> float | None:
    """Return the least of the largest loads of several directions, shape (D, 3).

    See `largest_load`; None if the bodies cannot bear their weight.
    """
    if not touches:
        return None
    A, least = _balance(touches, centres, friction, len(masses_kg)), _MOST
    for direction in directions:
        load = _borne(A, masses_kg, direction)
        if load is None:
            return None
        least = min(least, load)
    return least


def _borne(A: coo_matrix, masses_kg: Float, direction: Float) -> float | None:
    """Return the largest load of `largest_load` for what `_balance` has returned."""
    bodies, forces = len(masses_kg), A.shape[1]
    # A column for the share of the load; weights in units of the mean weight keep numbers near 1.
    weights = masses_kg / masses_kg.mean()
    load = np.zeros((bodies, 6))
    load[:, :3] = weights[:, None] * direction
    rows = np.arange(6 * bodies)
    column = coo_matrix(
        (load.ravel(), (rows, np.full(6 * bodies, forces))), (6 * bodies, forces + 1)
    )
    A = coo_matrix((A.data, (A.row, A.col)), (6 * bodies, forces + 1)) + column
    b = np.zeros((bodies, 6))
    b[:, 2] = weights
    cost = np.zeros(forces + 1)
    cost[-1] = -1.0
    bounds = [(0.0, None)] * forces + [(0.0, _MOST)]
    found = linprog(cost, A_eq=A.tocsr(), b_eq=b.ravel(), bounds=bounds, method="highs")
    return float(found.x[-1]) if found.status == 0 else None


def _balance(touches: Sequence[Touch], centres: Float, friction: float, bodies: int) -> coo_matrix:
    """Return what a unit of each edge of each pyramid does to each body, (6 B, sides · touches)."""
    rows, columns, values = [], [], []
    for number, touch in enumerate(touches):
        edges = _pyramid(touch.normal, friction)
        for body, sign in ((touch.first, -1.0), (touch.second, 1.0)):
            if body < 0:
                continue
            moment = np.cross(touch.point - centres[body], edges)
            rows.append(np.repeat(6 * body + np.arange(6)[None, :], _SIDES, axis=0))
            columns.append(np.repeat(_SIDES * number + np.arange(_SIDES)[:, None], 6, axis=1))
            values.append(sign * np.hstack([edges, moment]))
    place = tuple(np.concatenate([np.ravel(one) for one in part]) for part in (rows, columns))
    data = np.concatenate([one.ravel() for one in values])
    return coo_matrix((data, place), (6 * bodies, _SIDES * len(touches)))


def _pyramid(normal: Float, friction: float) -> Float:
    """Return the edges of the friction pyramid, each with a unit part along the normal, (8, 3)."""
    aside = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.7 else np.array([0.0, 1.0, 0.0])
    u = np.cross(normal, aside)
    u /= np.linalg.norm(u)
    angles = 2 * np.pi * np.arange(_SIDES) / _SIDES
    across = np.cos(angles)[:, None] * u + np.sin(angles)[:, None] * np.cross(normal, u)
    return np.asarray(normal + friction * across)
