"""Inverse kinematics by damped least squares, from several seeds, within joint limits."""

from collections.abc import Callable, Iterator

import numpy as np
from executive_plugins.motion.arm_chain import ArmChain
from executive_plugins.motion.damped_steps import compile_steps, damped_steps
from executive_plugins.motion.settings import InverseKinematicsSettings

from executive.arrays import Float
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_COMFORT = 2.0  # pull towards the middle of each range, in units of the scaled residual
_SAME = 0.02  # solutions closer than this are the same [rad] or [m]
_MAX_STEP = 0.4  # largest step to the solution next to a posture [rad] or [m]


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
        self._chain = ArmChain.of(machine)

    def compile(self) -> None:
        """Compile the loop, so that no request has to wait for it."""
        compile_steps(self._chain)

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
        """Return the result of Levenberg's method, and whether it reaches the pose."""
        q, away_m, away_rad = damped_steps(
            self._chain, T_wanted, q, iterations, pull, (self._lower, self._upper, self._comfort)
        )
        return q, bool(
            away_m <= self._settings.position_tolerance_m
            and away_rad <= self._settings.orientation_tolerance_rad
        )
