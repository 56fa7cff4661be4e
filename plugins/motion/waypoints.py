"""Way points of a move: straight up from the start, over what stands between, straight down to the
goal.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.motion.inverse_kinematics import InverseKinematics

from executive.arrays import Bool, Float
from executive.geometry.pose import pose, transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_STEP_M = 0.05  # of a straight line's nodes
_STRAIGHT = (
    0.75  # share of a line, from the low end, that has nodes; the rest bends into the travel
)
_CLIMB_M = 0.2  # of a lift's steps
_CLIMBED_M = 0.05  # less is no lift


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A straight motion between a low end and a top: joint positions, low end first, shape (K,
    n).
    """

    nodes: Float
    length_m: float


class Waypoints:
    """Finds joint positions for the parts of a move."""

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
        """Go straight along a unit direction with the orientation kept,
        as far as the arm reaches.
        """
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
        """Return positions with the gripper at a height (of its origin, base frame), on the same
        azimuth.

        The gripper climbs in steps; where one is out of reach, it is drawn towards the carrying
        radius instead. It ends as high as it gets. None if it is high enough already, or cannot
        climb at all.
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

    def ways_round(self, q_from: Float, q_to: Float) -> list[float]:
        """Return shifts of the turning joint at the far end, the shorter way first [rad]; one if it
        has ends.
        """
        if np.isfinite(self._machine.lower[self._turn]):
            return [0.0]
        turn = q_to[self._turn] - q_from[self._turn]
        return [0.0, -2 * np.pi if turn > 0 else 2 * np.pi]

    def shifted(self, nodes: Float, shift_rad: float) -> Float:
        """Shift the turning joint of nodes (K, n)."""
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
    """Return all nodes in order, and for each interval whether it is a piece of a straight line."""
    nodes = [*leave.nodes, *travel, *arrive.nodes[::-1]]
    is_dense = np.zeros(len(nodes) - 1, dtype=bool)
    is_dense[: max(len(leave.nodes) - 2, 0)] = True
    is_dense[len(nodes) - len(arrive.nodes) + 1 :] = True
    return np.array(nodes), is_dense


def hang_m(T_base_gripper: Float, points_gripper: Float) -> float:
    """Return how far points (N, 3), fixed to the gripper, reach below its origin [m]."""
    return float(T_base_gripper[2, 3] - transform(T_base_gripper, points_gripper)[:, 2].min())
