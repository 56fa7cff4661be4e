"""Where a stone lies in the jaws: a look at it, weighed against where it is expected."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3, log_so3
from executive.messages.alignment import Uncertainty


@dataclass(frozen=True, slots=True, eq=False)
class HeldPose:
    """A correction of the held stone's pose, in the gripper's frame.

    Attributes:
        T_gripper_gripper: Motion from the expected pose to the estimated one, shape (4, 4).
        covariance: Of its error: rotation [rad] and shift [m] about the stone's centre, (6, 6).
        shift_m: How far the stone's centre is from where it was expected [m].
        turn_rad: How far the stone is turned against what was expected [rad].
    """

    T_gripper_gripper: Float
    covariance: Float
    shift_m: float
    turn_rad: float

    @property
    def position_std_m(self) -> float:
        """Standard deviation of the position along its least certain axis [m]."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[3:, 3:])[-1]))

    @property
    def rotation_std_rad(self) -> float:
        """Standard deviation of the rotation about its least certain axis [rad]."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[:3, :3])[-1]))


def held_pose(
    T_model: Float, seen: Uncertainty, centre: Float, position_m: float, rotation_rad: float
) -> HeldPose:
    """Fuse a motion of the model, as it was seen, with the expectation that it has not moved.

    A Kalman update of the motion's rotation vector and of its shift of the stone's centre. What the
    view does not determine stays as expected. A motion that is larger than the expectation allows
    shows that the closing jaws have moved the stone: the expectation is then widened until its
    squared Mahalanobis distance is what it is on average (6; covariance matching: Mehra 1970).

    Args:
        T_model: The motion that lays the model onto the view, in the gripper's frame, (4, 4).
        seen: The error of that motion.
        centre: The stone's centre where it is expected [m], shape (3,).
        position_m: Standard deviation of the expected position along each axis [m].
        rotation_rad: Standard deviation of the expected rotation about each axis [rad].
    """
    moved = T_model[:3, :3] @ centre + T_model[:3, 3]
    x = np.concatenate([log_so3(T_model[:3, :3]), moved - centre])
    R = _about(seen, moved)
    P = np.diag([rotation_rad**2] * 3 + [position_m**2] * 3)
    P *= max(1.0, float(x @ np.linalg.solve(P + R, x)) / len(x))
    K = P @ np.linalg.inv(P + R)
    x = K @ x
    covariance = P - K @ P
    rotation = exp_so3(x[:3])
    T = pose(rotation, centre + x[3:] - rotation @ centre)
    shift_m, turn_rad = float(np.linalg.norm(x[3:])), float(np.linalg.norm(x[:3]))
    return HeldPose(T, 0.5 * (covariance + covariance.T), shift_m, turn_rad)


def _about(seen: Uncertainty, centre: Float) -> Float:
    """Return the covariance of the rotation and of the shift of another point, shape (6, 6)."""
    x, y, z = centre - seen.centre
    moves = np.eye(6)  # a rotation ω shifts a point at r from the centre by ω × r
    moves[3:, :3] = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    return np.asarray(moves @ seen.covariance @ moves.T)
