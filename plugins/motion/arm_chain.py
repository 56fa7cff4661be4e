"""The joints of an arm as arrays, and compiled loops over them."""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from executive.arrays import Bool, Float, read_only
from executive.machine.machine import Machine


@dataclass(frozen=True, slots=True, eq=False)
class ArmChain:
    """The arm's joints from the base to the gripper.

    Attributes:
        T_parent_joints: Frame of each joint in its parent link at position 0, shape (n, 4, 4).
        axes: Unit axes in the joints' frames, shape (n, 3).
        slides: Whether a joint is prismatic, shape (n,).
    """

    T_parent_joints: Float
    axes: Float
    slides: Bool

    @classmethod
    def of(cls, machine: Machine) -> "ArmChain":
        """Return the arm of a machine."""
        joints = machine.joints
        return cls(
            np.array([joint.T_parent_joint for joint in joints]),
            np.array([joint.axis for joint in joints], dtype=np.float64),
            np.array([joint.kind == "prismatic" for joint in joints]),
        )

    def frames(self, q: Float) -> Float:
        """Return T_base_link of the links that the joints move, shape (n, K, 4, 4).

        Args:
            q: Arm positions [rad] or [m], shape (K, n).
        """
        return np.asarray(_frames(self.T_parent_joints, self.axes, self.slides, read_only(q)))


@njit(cache=True)  # type: ignore[untyped-decorator]
def moved(T_parent: Float, axis: Float, slides: bool, value: float, T: Float, out: Float) -> None:
    """Write T @ T_parent @ motion(value) to `out`, all of shape (4, 4); the last rows are kept.

    The motion of a turning joint is Rodrigues' formula.
    """
    J, M = np.empty((3, 4)), np.empty((3, 3))
    for row in range(3):
        for column in range(4):
            total = T[row, 3] if column == 3 else 0.0
            for k in range(3):
                total += T[row, k] * T_parent[k, column]
            J[row, column] = total
    if slides:
        for row in range(3):
            out[row, 3] = J[row, 3]
            for column in range(3):
                out[row, column] = J[row, column]
                out[row, 3] += J[row, column] * value * axis[column]
        return
    x, y, z = axis
    sine, rest = math.sin(value), 1.0 - math.cos(value)
    M[0, 0], M[1, 1], M[2, 2] = (
        1.0 - rest * (y * y + z * z),
        1.0 - rest * (x * x + z * z),
        1.0 - rest * (x * x + y * y),
    )
    M[0, 1], M[1, 0] = rest * x * y - sine * z, rest * x * y + sine * z
    M[0, 2], M[2, 0] = rest * x * z + sine * y, rest * x * z - sine * y
    M[1, 2], M[2, 1] = rest * y * z - sine * x, rest * y * z + sine * x
    for row in range(3):
        out[row, 3] = J[row, 3]
        for column in range(3):
            out[row, column] = (
                J[row, 0] * M[0, column] + J[row, 1] * M[1, column] + J[row, 2] * M[2, column]
            )


@njit(cache=True)  # type: ignore[untyped-decorator]
def _frames(T_parents: Float, axes: Float, slides: Bool, q: Float) -> Float:
    frames = np.zeros((len(axes), len(q), 4, 4))
    frames[:, :, 3, 3] = 1.0
    base = np.eye(4)
    for k in range(len(q)):
        for j in range(len(axes)):
            T = base if j == 0 else frames[j - 1, k]
            moved(T_parents[j], axes[j], slides[j], q[k, j], T, frames[j, k])
    return frames
