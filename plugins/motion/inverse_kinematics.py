"""Inverse kinematics by damped least squares, from several seeds, within joint limits."""

from collections.abc import Callable, Iterator

import numpy as np
from executive_plugins.motion.settings import InverseKinematicsSettings

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.geometry.rotation import log_so3
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

# Rows of the residual are divided by these, so 1 mm and 5 mrad have the same weight.
_SCALE = np.array([1e-3] * 3 + [5e-3] * 3)
_CONVERGED = 0.1  # scaled residual, equivalent to 0.1 mm
_DAMPING = 1e-3  # relative to the scaled Jacobian, whose entries are of the order of 1,000
_COMFORT = 2.0  # pull towards the middle of each range, in units of the scaled residual
_FADE = 0.25  # factor on the pull in each iteration
_PATIENCE = 5  # iterations without an improvement of 5 % before giving up
_SAME = 0.02  # solutions closer than this are the same [rad] or [m]
_MAX_STEP = 0.4  # largest step, within which the linearisation is valid [rad] or [m]


class InverseKinematics:
    """Joint positions for poses of the gripper; deterministic, about a millisecond per pose.

    Arms with more than six joints have redundant freedom. It is resolved by a pull towards the
    middle of the joint ranges, which fades as the pose is reached. Arms with fewer joints reach
    only some orientations; the least-squares solution is accepted if its residual is within the
    tolerance.
    """

    def __init__(
        self, settings: InverseKinematicsSettings, machine: Machine, kinematics: Kinematics
    ) -> None:
        self._settings = settings
        self._machine = machine
        self._kinematics = kinematics
        self._lower = machine.lower + settings.margin
        self._upper = machine.upper - settings.margin
        self._is_bounded = np.isfinite(machine.lower)
        lower, upper = (
            np.where(self._is_bounded, ends, 0.0) for ends in (machine.lower, machine.upper)
        )
        self._comfort = (lower + upper) / 2
        self._pull = (
            np.where(self._is_bounded, _COMFORT / np.maximum(upper - lower, 1e-6), 0.0) ** 2
        )
        self._turn = machine.arm_names.index(machine.turn_joint)

    def solve(
        self, T_base_gripper: Float, seed: Float, accept: Callable[[Float], bool] | None = None
    ) -> Float | None:
        """Return positions (n,) that reach a pose, near a seed where possible, or None.

        Continuous joints are returned on the turn nearest to that of the seed.

        Args:
            T_base_gripper: The wanted pose, shape (4, 4).
            seed: Positions to start from first, shape (n,).
            accept: A further condition, such as freedom from collision; if it refuses a solution,
                the next seed is tried.
        """
        if np.hypot(*T_base_gripper[:2, 3]) > self._machine.reach_m + 1.0:
            return None  # far out of reach
        stuck: list[Float] = []
        for start in self._seeds(T_base_gripper, seed):
            q, is_there = self._iterate(
                T_base_gripper, start, self._settings.iterations, pull=self._pull
            )
            q = self.nearest_turn(q, seed)
            if is_there and (accept is None or accept(q)):
                return q
            if any(np.abs(q - other).max() < _SAME for other in stuck):
                return None  # two seeds end at the same posture: assume that others would, too
            stuck.append(q)
        return None

    def track(self, T_base_gripper: Float, q: Float) -> Float | None:
        """Return the solution next to a posture that nearly reaches the pose, or None."""
        found, is_there = self._iterate(T_base_gripper, q, 8, pull=np.zeros_like(q))
        return found if is_there and np.abs(found - q).max() <= _MAX_STEP else None

    def nearest_turn(self, q: Float, reference: Float) -> Float:
        """Shift continuous joints by whole turns to within half a turn of a reference."""
        turns = np.where(self._is_bounded, 0.0, np.round((reference - q) / (2 * np.pi)))
        return np.asarray(q + 2 * np.pi * turns)

    def _seeds(self, T_base_gripper: Float, seed: Float) -> Iterator[Float]:
        """Yield the seed, the named postures and the middle of the ranges.

        In each the cabin is turned to the place, and the last joint to the orientation.
        """
        for posture in (
            seed,
            *map(self._machine.posture, sorted(self._machine.postures)),
            self._comfort,
        ):
            q = np.clip(posture, self._lower, self._upper)
            q[self._turn] += self._azimuth_error(T_base_gripper, q)
            q[-1] += self._last_joint_error(T_base_gripper, q)
            yield np.clip(q, self._lower, self._upper)

    def _azimuth_error(self, T_base_gripper: Float, q: Float) -> float:
        p, p_wanted = self._kinematics.gripper(q)[:2, 3], T_base_gripper[:2, 3]
        # The plane of the arm has an offset d from the turning axis, so the azimuth of the gripper
        # deviates by asin(d / radius).
        turn = q[self._turn]
        d = float(-np.sin(turn) * p[0] + np.cos(turn) * p[1])
        radius = float(np.hypot(*p_wanted))
        offset = np.arcsin(np.clip(d / max(radius, 1e-6), -1.0, 1.0))
        return float(np.arctan2(p_wanted[1], p_wanted[0]) - offset - turn)

    def _last_joint_error(self, T_base_gripper: Float, q: Float) -> float:
        """Return the turn θ of the last joint that maximises tr(Rᵀ_wanted exp([θ a]×) R_now)."""
        if self._machine.joints[-1].kind == "prismatic":
            return 0.0
        R_now = self._kinematics.gripper(q)[:3, :3]
        M = R_now.T @ T_base_gripper[:3, :3]
        a = np.array(self._machine.joints[-1].axis)  # the gripper frame is that of the last joint
        sine = float(a @ [M[2, 1] - M[1, 2], M[0, 2] - M[2, 0], M[1, 0] - M[0, 1]])
        cosine = float(np.trace(M) - a @ M @ a)
        return float(np.arctan2(sine, cosine))

    def _iterate(
        self, T_wanted: Float, q: Float, iterations: int, pull: Float
    ) -> tuple[Float, bool]:
        """Return the result of Levenberg's method, and whether it reaches the pose.

        Joints at their limits form the active set. The pull fades with each step, so it only
        resolves redundant freedom.
        """
        q, best, stale = q.copy(), np.inf, 0
        r = self._residual(T_wanted, q)
        for i in range(iterations):
            size = float(np.linalg.norm(r))
            stale = 0 if size < 0.95 * best else stale + 1
            best = min(best, size)
            if size < _CONVERGED or stale > _PATIENCE:
                break
            q = self._step(r, q, pull * _FADE**i)
            r = self._residual(T_wanted, q)
        missed = r * _SCALE
        is_near = np.linalg.norm(missed[:3]) <= self._settings.position_tolerance_m
        return q, bool(
            is_near and np.linalg.norm(missed[3:]) <= self._settings.orientation_tolerance_rad
        )

    def _residual(self, T_wanted: Float, q: Float) -> Float:
        T = self._kinematics.gripper(q)
        turn = T[:3, :3] @ log_so3((inverse(T) @ T_wanted)[:3, :3])
        return np.asarray(np.concatenate([T_wanted[:3, 3] - T[:3, 3], turn]) / _SCALE)

    def _step(self, r: Float, q: Float, pull: Float) -> Float:
        A = self._kinematics.jacobian(q) / _SCALE[:, None]
        pull = pull * float(np.linalg.norm(A, axis=0).mean()) ** 2 / 1e3
        H = A.T @ A + np.diag(_DAMPING * np.abs(A).max() + pull)
        g = A.T @ r + pull * (self._comfort - q)
        dq = np.linalg.solve(H, g)
        is_blocked = ((q <= self._lower) & (dq < 0)) | ((q >= self._upper) & (dq > 0))
        if is_blocked.any():
            free = np.flatnonzero(~is_blocked)
            dq = np.zeros_like(q)
            dq[free] = np.linalg.solve(H[free[:, None], free], g[free])
        dq *= min(1.0, _MAX_STEP / max(float(np.abs(dq).max()), 1e-12))
        return np.clip(q + dq, self._lower, self._upper)
