"""Forward kinematics of the arm for many postures at once, as collision checks of paths need."""

import numpy as np
from executive_plugins.motion.arm_chain import ArmChain

from executive.arrays import Float
from executive.machine.gripper import SIDES
from executive.machine.machine import Machine


def link_frames(machine: Machine, q: Float, jaw_rad: float) -> dict[str, Float]:
    """Return T_base_link of every link for each posture, shape (K, 4, 4) each.

    Pinocchio takes one posture per call. Both agree to 1e-12 m (tests/plugins/motion).

    Args:
        machine: Machine whose links are computed.
        q: Arm positions [rad] or [m], shape (K, n).
        jaw_rad: Jaw angle, the same in all postures [rad].
    """
    moving = ArmChain.of(machine).frames(q)
    frames = {machine.base_link: np.broadcast_to(np.eye(4), (len(q), 4, 4))}
    frames |= {joint.child: T for joint, T in zip(machine.joints, moving, strict=True)}
    for side in SIDES:
        frames[side] = moving[-1] @ machine.gripper.T_gripper_jaw(side, jaw_rad)
    return frames
