"""Levenberg's method for the posture of a pose of the gripper, in one compiled loop."""

import math

import numpy as np
from executive_plugins.motion.arm_chain import ArmChain, moved
from numba import njit

from executive.arrays import Bool, Float, read_only

# Rows of the residual are divided by these, so 1 mm and 5 mrad have the same weight.
_LENGTH_M, _ANGLE_RAD = 1e-3, 5e-3
_CONVERGED = 0.1  # scaled residual, equivalent to 0.1 mm
_DAMPING = 1e-3  # relative to the scaled Jacobian, whose entries are of the order of 1,000
_FADE = 0.25  # factor on the pull in each iteration
_PATIENCE = 5  # iterations without an improvement of 5 % before giving up
_Arm = tuple[Float, Float, Bool]
_Limits = tuple[Float, Float, Float]
_MAX_STEP = 0.4  # largest step, within which the linearisation is valid [rad] or [m]


def damped_steps(
    chain: ArmChain,
    T_wanted: Float,
    q: Float,
    iterations: int,
    pull: Float,
    limits: _Limits,
) -> tuple[Float, float, float]:
    """Return the posture that the method ends at, and by how much it misses the pose [m], [rad].

    Joints at their limits form the active set. The pull fades with each step, so it only resolves
    redundant freedom.

    Args:
        chain: The arm, n joints.
        T_wanted: Wanted pose of the gripper in the base, shape (4, 4).
        q: Posture to begin at, shape (n,).
        iterations: Largest number of steps.
        pull: Weights of the pull towards the comfortable posture, shape (n,).
        limits: Lower and upper limits and the comfortable posture, shape (n,) each.
    """
    q = np.array(q, dtype=np.float64)
    arm = chain.T_parent_joints, chain.axes, chain.slides
    wanted, pull = read_only(T_wanted), np.asarray(pull, dtype=np.float64)
    missed = np.asarray(_iterate(arm, wanted, q, iterations, pull, limits))
    return q, float(np.linalg.norm(missed[:3])), float(np.linalg.norm(missed[3:]))


def compile_steps(chain: ArmChain) -> None:
    """Compile the loops, which takes seconds on the first run after an installation."""
    zeros = np.zeros(len(chain.axes))
    chain.frames(zeros[None])
    damped_steps(chain, np.eye(4), zeros, 1, zeros, (zeros - 1, zeros + 1, zeros))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _iterate(
    arm: _Arm, T_wanted: Float, q: Float, iterations: int, pull: Float, limits: _Limits
) -> Float:
    """Change q (n,) in place; return what is missed: position [m], then rotation [rad], (6,)."""
    T_parents, axes, slides = arm
    frames = np.zeros((len(q), 4, 4))
    frames[:, 3, 3] = 1.0
    missed, best, stale = np.empty(6), np.inf, 0
    for i in range(iterations + 1):
        for j in range(len(q)):
            T = np.eye(4) if j == 0 else frames[j - 1]
            moved(T_parents[j], axes[j], slides[j], q[j], T, frames[j])
        _miss(frames[-1], T_wanted, missed)
        size = 0.0
        for row in range(6):
            size += (missed[row] / (_LENGTH_M if row < 3 else _ANGLE_RAD)) ** 2
        size = math.sqrt(size)
        stale = 0 if size < 0.95 * best else stale + 1
        best = min(best, size)
        if size < _CONVERGED or stale > _PATIENCE or i == iterations:
            break
        _step(frames, arm, missed, q, pull * _FADE**i, limits)
    return missed


@njit(cache=True)  # type: ignore[untyped-decorator]
def _miss(T: Float, T_wanted: Float, missed: Float) -> None:
    """Write the way and the rotation vector in base axes from a pose to the wanted one, (6,)."""
    R = np.zeros((3, 3))  # R_wanted Rᵀ: its rotation vector is that from T to T_wanted in the base
    for row in range(3):
        missed[row] = T_wanted[row, 3] - T[row, 3]
        for column in range(3):
            for k in range(3):
                R[row, column] += T_wanted[row, k] * T[column, k]
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    # Shepperd 1978, as in `executive.geometry.rotation`
    largest = max(trace, R[0, 0], R[1, 1], R[2, 2])
    if largest == trace:
        w, x, y, z = 1.0 + trace, R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    elif largest == R[0, 0]:
        w, x = R[2, 1] - R[1, 2], 1.0 + R[0, 0] - R[1, 1] - R[2, 2]
        y, z = R[1, 0] + R[0, 1], R[2, 0] + R[0, 2]
    elif largest == R[1, 1]:
        w, x = R[0, 2] - R[2, 0], R[0, 1] + R[1, 0]
        y, z = 1.0 + R[1, 1] - R[2, 2] - R[0, 0], R[2, 1] + R[1, 2]
    else:
        w, x = R[1, 0] - R[0, 1], R[0, 2] + R[2, 0]
        y, z = R[2, 1] + R[1, 2], 1.0 + R[2, 2] - R[0, 0] - R[1, 1]
    length = math.sqrt(w * w + x * x + y * y + z * z)
    length = -length if w < 0 else length
    w, x, y, z = w / length, x / length, y / length, z / length
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 if sine < 1e-12 else 2.0 * math.atan2(sine, w) / sine
    missed[3], missed[4], missed[5] = scale * x, scale * y, scale * z


@njit(cache=True)  # type: ignore[untyped-decorator]
def _step(frames: Float, arm: _Arm, missed: Float, q: Float, pull: Float, limits: _Limits) -> None:
    """Change q (n,) by one damped step within the limits."""
    n, (lower, upper, comfort) = len(q), limits
    A = _jacobian(frames, arm[1], arm[2])
    most, norms = np.zeros(n), 0.0
    for j in range(n):
        square = 0.0
        for row in range(6):
            A[row, j] /= _LENGTH_M if row < 3 else _ANGLE_RAD
            most[j] = max(most[j], abs(A[row, j]))
            square += A[row, j] ** 2
        norms += math.sqrt(square)
    weight = (norms / n) ** 2 / 1e3
    damping, H, g = _DAMPING * most.max(), np.zeros((n, n)), np.zeros(n)
    for j in range(n):
        g[j] = weight * pull[j] * (comfort[j] - q[j])
        for row in range(6):
            g[j] += A[row, j] * missed[row] / (_LENGTH_M if row < 3 else _ANGLE_RAD)
            for k in range(n):
                H[j, k] += A[row, j] * A[row, k]
        H[j, j] += damping + weight * pull[j]
    is_free = np.ones(n, dtype=np.bool_)
    dq = _solved(H, g, is_free)
    for j in range(n):
        if (q[j] <= lower[j] and dq[j] < 0) or (q[j] >= upper[j] and dq[j] > 0):
            is_free[j] = False
    if not is_free.all():
        dq = _solved(H, g, is_free)
    share = min(1.0, _MAX_STEP / max(np.abs(dq).max(), 1e-12))
    for j in range(n):
        q[j] = min(max(q[j] + share * dq[j], lower[j]), upper[j])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _jacobian(frames: Float, axes: Float, slides: Bool) -> Float:
    """Return the Jacobian of the last frame in base axes, linear rows first, shape (6, n)."""
    J, tip = np.zeros((6, len(axes))), frames[-1]
    for j in range(len(axes)):
        T, axis = frames[j], np.zeros(3)  # a joint's motion leaves its own axis where it is
        for row in range(3):
            for k in range(3):
                axis[row] += T[row, k] * axes[j, k]
        if slides[j]:
            J[:3, j] = axis
            continue
        x, y, z = tip[0, 3] - T[0, 3], tip[1, 3] - T[1, 3], tip[2, 3] - T[2, 3]
        J[0, j] = axis[1] * z - axis[2] * y
        J[1, j] = axis[2] * x - axis[0] * z
        J[2, j] = axis[0] * y - axis[1] * x
        J[3:, j] = axis
    return J


@njit(cache=True)  # type: ignore[untyped-decorator]
def _solved(H: Float, g: Float, is_free: Bool) -> Float:
    """Return x with H x = g for the free unknowns, 0 for the others; H is positive definite.

    Source: Cholesky's factorisation, row by row.
    """
    free = np.flatnonzero(is_free)
    n = len(free)
    L, y, x = np.zeros((n, n)), np.zeros(n), np.zeros(len(g))
    for i in range(n):
        for j in range(i + 1):
            total = H[free[i], free[j]]
            for k in range(j):
                total -= L[i, k] * L[j, k]
            L[i, j] = math.sqrt(total) if i == j else total / L[j, j]
        total = g[free[i]]
        for k in range(i):
            total -= L[i, k] * y[k]
        y[i] = total / L[i, i]
    for i in range(n - 1, -1, -1):
        total = y[i]
        for k in range(i + 1, n):
            total -= L[k, i] * x[free[k]]
        x[free[i]] = total / L[i, i]
    return x
