"""Waypoints of a move: straight up from the start, over obstacles, straight down to the goal."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from executive_plugins.motion.inverse_kinematics import InverseKinematics

from executive.arrays import Bool, Float
from executive.geometry.pose import pose, transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_STEP_M = 0.05  # between nodes of a straight line
_STRAIGHT = 0.75  # share of a line, from the low end, with nodes; the rest bends into the travel
_CLIMB_M = 0.2  # step of a lift
_CLIMBED_M = 0.05  # smaller lifts are left out


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A straight motion between a low end and a top.

    Attributes:
        nodes: Joint positions, low end first, shape (K, n).
        length_m: Length of the line.
    """

    nodes: Float
    length_m: float


class Waypoints:
    """Computes joint positions for the parts of a move."""

    def __init__(
        self, machine: Machine, kinematics: Kinematics, inverse_kinematics: InverseKinematics
    ) -> None:
        self._machine = machine
        self._kinematics = kinematics
        self._ik = inverse_kinematics
        self._turn = machine.arm_names.index(machine.turn_joint)
        carry = kinematics.gripper(machine.posture("carry"))
        self._carry_radius_m = float(np.hypot(*carry[:2, 3]))

    def line_up(self, q_low: Float, direction: Float, length_m: float) -> Line:
        """Move along a unit direction with constant orientation, as far as the arm reaches."""
        T_low = self._kinematics.gripper(q_low)
        q, nodes = q_low, [q_low]
        count = int(np.ceil(length_m / _STEP_M))
        for i in range(1, count + 1):
            found = self._ik.track(pose(t=direction * length_m * i / count) @ T_low, q)
            if found is None:
                count = i - 1
                break
            q = found
            nodes.append(q)
        reached_m = length_m * count / max(int(np.ceil(length_m / _STEP_M)), 1)
        straight = int(np.ceil(_STRAIGHT * count))
        return Line(
            np.array([*nodes[: straight + 1], *nodes[count:]] if straight < count else nodes),
            reached_m,
        )

    def lift(self, q_top: Float, height_m: float) -> Float | None:
        """Return positions with the gripper at a height, on the same azimuth.

        The height is that of the gripper's origin in the base frame. The gripper climbs in steps;
        where a step is out of reach, it moves towards the carrying radius instead. It ends as high
        as it gets. None if it is high enough already, or cannot climb at all.
        """
        T, q = self._kinematics.gripper(q_top), q_top
        start_m = T[2, 3]
        while T[2, 3] < height_m - _CLIMBED_M:
            step_m = min(_CLIMB_M, height_m - T[2, 3])
            steps = [(pose(t=np.array([0.0, 0.0, step_m])) @ T), self._drawn_in(T)]
            tried = next(((S, p) for S in steps if (p := self._ik.track(S, q)) is not None), None)
            if tried is None or np.allclose(tried[0], T):
                break
            T, q = tried
        return q if T[2, 3] > start_m + _CLIMBED_M else None

    def drawn(self, q: Float, radius_m: float) -> Float | None:
        """Return positions with the gripper at a radius about the base, nearer than it is.

        Height, azimuth and orientation are kept. None if it is as near already, or the arm does
        not get there.
        """
        T = self._kinematics.gripper(q)
        from_m = float(np.hypot(*T[:2, 3]))
        if from_m <= radius_m + _CLIMBED_M:
            return None
        for to_m in np.linspace(from_m, radius_m, int(np.ceil((from_m - radius_m) / _CLIMB_M)) + 1):
            nearer = T.copy()
            nearer[:2, 3] *= to_m / from_m
            found = self._ik.track(nearer, q)
            if found is None:
                return None
            q = found
        return q

    def drawn_until(
        self, q: Float, nearest_m: float, is_near: Callable[[Float], bool]
    ) -> Float | None:
        """Return positions as `drawn` does, only as near as it takes; None if it takes more.

        Args:
            q: Positions to begin with; they are returned if they are near enough.
            nearest_m: The least radius that is tried.
            is_near: Whether positions are near enough; what is nearer than such is, too.
        """
        if is_near(q):
            return q
        near_m, far_m = nearest_m, float(np.hypot(*self._kinematics.gripper(q)[:2, 3]))
        found: Float | None = None
        while far_m - near_m > 2 * _CLIMBED_M:
            middle_m = (near_m + far_m) / 2
            drawn = self.drawn(q, middle_m)
            if drawn is not None and not is_near(drawn):
                far_m = middle_m
                continue
            near_m, found = middle_m, found if drawn is None else drawn
        return found

    @property
    def carry_radius_m(self) -> float:
        """Distance of the gripper from the middle of the base in the posture `carry` [m]."""
        return self._carry_radius_m

    def turn_shifts(self, q_from: Float, q_to: Float) -> list[float]:
        """Return shifts of the turning joint at the far end, shorter turn first [rad].

        There is only one if the joint has limits.
        """
        if np.isfinite(self._machine.lower[self._turn]):
            return [0.0]
        turn = q_to[self._turn] - q_from[self._turn]
        return [0.0, -2 * np.pi if turn > 0 else 2 * np.pi]

    def shifted(self, nodes: Float, shift_rad: float) -> Float:
        """Return nodes (K, n) with the turning joint shifted."""
        nodes = nodes.copy()
        nodes[:, self._turn] += shift_rad
        return nodes

    def _drawn_in(self, T: Float) -> Float:
        radius = float(np.hypot(*T[:2, 3]))
        step_m = float(np.clip(self._carry_radius_m - radius, -_CLIMB_M, _CLIMB_M))
        drawn = T.copy()
        drawn[:2, 3] *= 1 + step_m / max(radius, 1e-6)
        return drawn


def join(leave: Line, travel: list[Float], arrive: Line) -> tuple[Float, Bool]:
    """Return all nodes in order, and for each interval whether it belongs to a straight line."""
    nodes = [*leave.nodes, *travel, *arrive.nodes[::-1]]
    is_dense = np.zeros(len(nodes) - 1, dtype=bool)
    is_dense[: max(len(leave.nodes) - 2, 0)] = True
    is_dense[len(nodes) - len(arrive.nodes) + 1 :] = True
    return np.array(nodes), is_dense


def reach_below_m(T_base_gripper: Float, points_gripper: Float) -> float:
    """Return how far points (N, 3), fixed to the gripper, reach below its origin [m]."""
    return float(T_base_gripper[2, 3] - transform(T_base_gripper, points_gripper)[:, 2].min())
