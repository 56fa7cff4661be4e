"""Steps of least squares that lay points with planes over a surface."""

from typing import NamedTuple

import numpy as np
from executive_plugins.alignment.surface import Planes, Surface
from numba import njit

from executive.arrays import Float, read_only
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3

_ALONG, _ACROSS = 1.0, 1e-3  # variances of a plane's points along and across it (Segal 2009)
_FACING = float(np.sqrt(0.5))  # faces that look alike differ by less than 45 degrees
# Small steps that have grown so often go round in a circle, of pairs that come and go.
_STALLS, _NEARLY = 3, 10.0
_DAMPING = 1e-6  # of directions that no point determines


class Rule(NamedTuple):
    """What a fit minimises, and when it ends.

    Attributes:
        is_generalised: Whether both surfaces' planes count (Segal 2009), or the target's alone.
        reach_m: Correspondences are nearer than this [m].
        dense_m: And nearer than this [m], unless the target's plane holds farther.
        holds: How far a plane holds, in the radius of the points that shape it.
        settled_m: The fit ends when points move less than this, root mean square [m].
        most: Number of steps at most.
        least: Number of correspondences without which the fit ends.
    """

    is_generalised: bool
    reach_m: float
    dense_m: float
    holds: float
    settled_m: float
    most: int
    least: int


def descend(target: Surface, source: Float, planes: Planes, T: Float, rule: Rule) -> Float:
    """Move a source's points (N, 3) onto the target from a motion; return where steps end.

    Each step pairs a source point with the nearest target point whose face looks alike: the bottom
    and the far side of a stone, which the target does not show, must not pair with the ground and
    the near side. Points without a plane have no pair.
    """
    middle = source.mean(axis=0)
    radius_m = float(np.sqrt(np.mean(np.sum((source - middle) ** 2, axis=1))))
    last_m, stalls = np.inf, 0
    for _ in range(rule.most):
        about = transform(T, middle)
        paired = _pairs(target, transform(T, source), planes, T[:3, :3], rule)
        H, g, pairs = _normal_equations(*paired, about, rule.is_generalised)
        if pairs < rule.least:
            return T
        step = np.linalg.solve(H + _DAMPING * np.trace(H) / 6 * np.eye(6), g)
        T = pose(t=about) @ pose(exp_so3(step[:3]), step[3:]) @ pose(t=-about) @ T
        moves_m = np.hypot(np.linalg.norm(step[3:]), radius_m * np.linalg.norm(step[:3]))
        stalls += last_m <= moves_m < _NEARLY * rule.settled_m
        if moves_m < rule.settled_m or stalls == _STALLS:
            return T
        last_m = moves_m
    return T


def _pairs(
    target: Surface, moved: Float, planes: Planes, R: Float, rule: Rule
) -> tuple[Float, Float, Float, Float]:
    """Return points and normals of the source, and of the target, each of shape (M, 3)."""
    distances, rows = target.within(moved, rule.reach_m)
    met = np.flatnonzero((rows < len(target)) & (planes.radii_m > 0.0))
    rows = rows.take(met)
    beside = target.planes(rows)
    holds_m = np.maximum(rule.dense_m, rule.holds * beside.radii_m)
    near = np.flatnonzero((distances.take(met) < holds_m) & (beside.radii_m > 0.0))
    met, rows = met.take(near), rows.take(near)
    return (
        moved.take(met, axis=0),
        planes.normals.take(met, axis=0) @ read_only(R.T),
        target.points.take(rows, axis=0),
        beside.normals.take(near, axis=0),
    )


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _normal_equations(
    moved: Float, faces: Float, met: Float, normals: Float, about: Float, is_generalised: bool
) -> tuple[Float, Float, int]:  # pragma: no cover - compiled
    """Return the Hessian (6, 6), the right side (6,), and the number of pairs.

    The unknowns are a rotation [rad] about a point and a shift [m]. Of each pair, whose offset is
    d, dᵀ W d is minimised; see `_weigh`.
    """
    H, g, W = np.zeros((6, 6)), np.zeros(6), np.zeros((3, 3))
    J, WJ = np.zeros((3, 6)), np.zeros((3, 6))
    J[0, 3] = J[1, 4] = J[2, 5] = 1.0
    pairs = 0
    for m in range(len(moved)):
        n, f = normals[m], faces[m]
        cosine = n[0] * f[0] + n[1] * f[1] + n[2] * f[2]
        if abs(cosine) <= _FACING:
            continue
        pairs += 1
        _weigh(n, f, cosine, is_generalised, W)
        x, y, z = moved[m, 0] - about[0], moved[m, 1] - about[1], moved[m, 2] - about[2]
        J[0, 1], J[0, 2], J[1, 0] = z, -y, -z
        J[1, 2], J[2, 0], J[2, 1] = x, y, -x
        for i in range(3):
            for j in range(6):
                WJ[i, j] = W[i, 0] * J[0, j] + W[i, 1] * J[1, j] + W[i, 2] * J[2, j]
        for i in range(6):
            for k in range(3):
                g[i] += WJ[k, i] * (met[m, k] - moved[m, k])
                for j in range(6):
                    H[i, j] += J[k, i] * WJ[k, j]
    return H, g, pairs


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _weigh(
    n: Float, f: Float, cosine: float, is_generalised: bool, W: Float
) -> None:  # pragma: no cover - compiled
    """Write the weight of a pair's offset from the normals of target and source, shape (3, 3).

    For point-to-plane it is n nᵀ; for generalised ICP the inverse of the sum of both planes'
    covariances, whose eigenvectors are n + f, n - f, and the vector across both.
    """
    if not is_generalised:
        for i in range(3):
            for j in range(3):
                W[i, j] = n[i] * n[j]
        return
    flat, plain = _ALONG - _ACROSS, 0.5 / _ALONG
    side = 1.0 if cosine > 0 else -1.0
    both = 1.0 + side * cosine  # half the square of n + f, and its share of n nᵀ + f fᵀ
    apart = max(2.0 - both, 1e-12)  # the same of n - f
    on = (1.0 / (2 * _ALONG - flat * both) - plain) / (2 * both)
    off = (1.0 / (2 * _ALONG - flat * apart) - plain) / (2 * apart)
    for i in range(3):
        for j in range(3):
            W[i, j] = on * (n[i] + side * f[i]) * (n[j] + side * f[j])
            W[i, j] += off * (n[i] - side * f[i]) * (n[j] - side * f[j])
        W[i, i] += plain
