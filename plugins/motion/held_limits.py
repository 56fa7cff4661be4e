"""How hard and how suddenly the joints may accelerate a held stone."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.motion.settings import HermiteSettings
from executive_plugins.motion.timing import Limits

from executive.arrays import Float
from executive.machine.kinematics import Kinematics

_LEAST_LEVER = 1e-3  # of a joint whose axis passes through the gripper: no limit follows from it


@dataclass(frozen=True, slots=True, eq=False)
class Levers:
    """Speed of the gripper for unit speed of each joint, (n,) each [m/rad, or 1].

    Attributes:
        up: Its vertical part.
        sideways: Its horizontal part.
    """

    up: Float
    sideways: Float

    @classmethod
    def at(cls, kinematics: Kinematics, *postures: Float) -> "Levers":
        """Return the largest ones of postures."""
        J = np.stack([kinematics.jacobian(q) for q in postures])
        sideways = np.linalg.norm(J[:, :2], axis=1)
        return cls(np.abs(J[:, 2]).max(axis=0), sideways.max(axis=0))


def held_limits(
    limits: Limits, levers: Levers, settings: HermiteSettings, sway_s: float = 0.0
) -> Limits:
    """Return limits under which no joint alone accelerates a held stone by more than is set.

    Args:
        limits: Those of the joints.
        levers: Those of the motion.
        settings: How hard and how suddenly.
        sway_s: Period of the sway of a machine on supports that yield, over which the motion is
            averaged [s]: that leaves no sway of this period.
    """
    up = settings.held_up_m_s2 / np.maximum(levers.up, _LEAST_LEVER)
    sideways = settings.held_sideways_m_s2 / np.maximum(levers.sideways, _LEAST_LEVER)
    acceleration = np.minimum(limits.acceleration, np.minimum(up, sideways))
    jerk = np.minimum(limits.jerk, acceleration / settings.held_ramp)
    return Limits(limits.velocity, acceleration, jerk, limits.flow, sway_s)
