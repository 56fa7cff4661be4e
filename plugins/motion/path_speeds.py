"""The fastest motion along a path within the limits of all joints and of their oil."""

import numpy as np
from executive_plugins.motion.oil_flow import OilFlow
from executive_plugins.motion.path import HermitePath
from numba import njit

from executive.arrays import Float

_GRID = 0.02  # largest step of the parameter
_BESIDE = 1e-6  # share of a step by which curvature is read beside a node, where it jumps
_FLAT = 1e-9  # a smaller coefficient of the acceleration counts as none
# Share of the highest b that is kept where no acceleration keeps all limits, so that the motion
# goes on; the timing slows down as a whole until they hold.
_LEAST_SHARE = 1e-4
_UNBOUNDED = 1e6  # square of the parameter's speed where no joint moves


def path_speeds(
    path: HermitePath, max_velocity: Float, max_acceleration: Float, flow: OilFlow | None = None
) -> tuple[Float, Float]:
    """Return parameters (m + 1,) and the squares of the parameter's highest speeds there, (m + 1,).

    The parameter's acceleration is constant on each step; it starts and ends at rest. With speed
    v = du/dt, b = v² and a = dv/dt the joints' accelerations are q'(u) a + q''(u) b. They keep
    their limits at both ends of each step (collocation with interpolation), where q'' is that of
    the step's own side.

    Source: reachability analysis, Pham and Pham, "A new approach to time-optimal path
    parameterization based on reachability analysis", T-RO 2018, Sec. III. The linear programs of
    one step have two unknowns, and their solutions are written out here. The flow of oil limits the
    parameter's speed as a joint's velocity does.
    """
    u = _grid(path.parameters)
    du = np.diff(u)
    begin, end = u[:-1] + _BESIDE * du, u[1:] - _BESIDE * du
    slopes = path.tangent(begin), path.tangent(end)
    bends = path.curvature(begin), path.curvature(end)
    # |of_a a + of_b b| ≤ limit with a, b at the beginning of a step; at its end b is b + 2 du a.
    of_a = np.hstack([slopes[0], slopes[1] + 2 * du[:, None] * bends[1]])
    of_b = np.hstack(bends)
    limit = np.tile(max_acceleration, 2)
    caps = np.full(len(u), _UNBOUNDED)
    for sides, slope in ((slice(None, -1), slopes[0]), (slice(1, None), slopes[1])):
        fastest = (max_velocity / np.maximum(np.abs(slope), _FLAT)).min(axis=1)
        if flow is not None:
            fastest = np.minimum(fastest, flow.fastest(slope))
        caps[sides] = np.minimum(caps[sides], fastest**2)
    caps[:-1] = np.minimum(caps[:-1], _without_acceleration(of_a, of_b, limit))
    return u, _fastest(_controllable(caps, du, of_a, of_b, limit), du, of_a, of_b, limit)


def compile_speeds(joints: int) -> None:
    """Compile the loops, which takes seconds on the first run after an installation."""
    limit = np.ones(joints)
    path_speeds(HermitePath(np.zeros((2, joints)), np.array([0.0, 1.0])), limit, limit)


def _grid(nodes: Float) -> Float:
    # From rest to rest takes two steps.
    counts = np.maximum(2, np.ceil(np.diff(nodes) / _GRID)).astype(np.int64)
    places = np.concatenate([[0], np.cumsum(counts)])
    return np.asarray(np.interp(np.arange(places[-1] + 1), places, nodes))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _without_acceleration(of_a: Float, of_b: Float, limit: Float) -> Float:
    """Return the largest b of each step for which any acceleration keeps all limits, shape (m,)."""
    caps = np.full(len(of_a), _UNBOUNDED)
    for i in range(len(of_a)):
        for j in range(len(limit)):
            p, r = of_a[i, j], of_b[i, j]
            if abs(p) < _FLAT:
                if abs(r) * caps[i] > limit[j]:
                    caps[i] = limit[j] / abs(r)
                continue
            for k in range(len(limit)):
                # The most that joint j allows falls below the least that joint k needs.
                if abs(of_a[i, k]) < _FLAT:
                    continue
                gap = limit[j] / abs(p) + limit[k] / abs(of_a[i, k])
                closing = r / p - of_b[i, k] / of_a[i, k]
                if closing * caps[i] > gap:
                    caps[i] = gap / closing
    return caps


@njit(cache=True)  # type: ignore[untyped-decorator]
def _controllable(caps: Float, du: Float, of_a: Float, of_b: Float, limit: Float) -> Float:
    """Return the largest b at each parameter from which the end can be reached at rest."""
    most = np.zeros(len(caps))
    for i in range(len(du) - 1, -1, -1):
        b = caps[i]
        for j in range(len(limit)):
            p, r = of_a[i, j], of_b[i, j]
            if abs(p) < _FLAT:
                continue
            # The strongest braking, a = −limit/|p| − r/p b, must lead to `most` of the next.
            share = 1.0 - 2.0 * du[i] * r / p
            reached = most[i + 1] + 2.0 * du[i] * limit[j] / abs(p)
            if share * b > reached:
                b = reached / share
        most[i] = b
    return most


@njit(cache=True)  # type: ignore[untyped-decorator]
def _fastest(most: Float, du: Float, of_a: Float, of_b: Float, limit: Float) -> Float:
    """Return the largest b at each parameter that can be reached from rest at the start."""
    b = np.zeros(len(most))
    for i in range(len(du)):
        reached = most[i + 1]
        for j in range(len(limit)):
            p = of_a[i, j]
            if abs(p) >= _FLAT:
                a = limit[j] / abs(p) - of_b[i, j] / p * b[i]
                reached = min(reached, b[i] + 2.0 * du[i] * a)
        b[i + 1] = max(reached, _LEAST_SHARE * most[i + 1])
    return b
