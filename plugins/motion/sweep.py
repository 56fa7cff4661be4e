"""Sweeps of the cabin for scanning: fold the arm, turn to +angle/2, to −angle/2 and back."""

import numpy as np
from executive_plugins.motion.path import path_through
from executive_plugins.motion.straight import time_line
from executive_plugins.motion.timing import Limits, time_path

from executive.arrays import Float
from executive.machine.machine import Machine
from executive.messages.trajectory import JointTrajectory

_ROUNDED = 3  # times that the ends are moved outwards: timing rounds a reversal by some 5 mrad
_STILL = 1e-3  # smaller motions are left out [rad] or [m]


def sweep(
    machine: Machine, limits: Limits, fold: list[Float], angle_rad: float, duration_s: float
) -> JointTrajectory:
    """Fold the arm, then sweep the cabin around its present direction.

    The sweep alone takes the given duration, or longer where the limits require it.

    Args:
        machine: Machine that sweeps.
        limits: Limits of the joints.
        fold: Postures from the present one to the folded one, without turning the cabin, each (n,).
        angle_rad: Total angle of the sweep.
        duration_s: Wanted duration of the sweep [s].
    """
    turning = _sweeping(machine, limits, [fold[-1]], angle_rad, duration_s)
    if np.abs(fold[-1] - fold[0]).max() < _STILL:
        return turning
    return chain([_through(machine, limits, fold), turning])


def folding_sweep(
    machine: Machine, limits: Limits, fold: list[Float], angle_rad: float, duration_s: float
) -> JointTrajectory:
    """Fold the arm while the cabin turns to +angle/2, then turn to −angle/2 and back.

    The arm is folded from +angle/2 on, so that all directions are seen past the folded arm. The
    whole motion takes the given duration, or longer where the limits require it. Arguments as for
    `sweep`; a negative angle turns to the other side first.
    """
    return _sweeping(machine, limits, fold, angle_rad, duration_s)


def chain(parts: list[JointTrajectory]) -> JointTrajectory:
    """Concatenate trajectories; each starts at rest where the previous one ends."""
    starts = np.cumsum([0.0, *(part.duration_s for part in parts)])
    return JointTrajectory(
        parts[0].names,
        np.concatenate(
            [
                p.times_s[i > 0 :] + start
                for i, (p, start) in enumerate(zip(parts, starts, strict=False))
            ]
        ),
        np.concatenate([p.position[i > 0 :] for i, p in enumerate(parts)]),
        np.concatenate([p.velocity[i > 0 :] for i, p in enumerate(parts)]),
    )


def _sweeping(
    machine: Machine, limits: Limits, fold: list[Float], angle_rad: float, duration_s: float
) -> JointTrajectory:
    """Return a motion from the first posture of a fold to both sides and back, without a stop."""
    joint = machine.arm_names.index(machine.turn_joint)
    shares = np.linspace(0.0, 1.0, max(2, len(fold)))[:, None]
    postures = np.array(fold if len(fold) > 1 else [fold[0], fold[0]])
    wanted = fold[-1][joint] + angle_rad / 2 * np.array([1.0, -1.0])
    turn = np.eye(len(machine.joints))[joint]
    ends = angle_rad / 2 * np.array([1.0, -1.0])
    for _ in range(_ROUNDED):
        nodes = [*(postures + shares * ends[0] * turn), fold[-1] + ends[1] * turn, fold[-1]]
        whole = _through(machine, limits, nodes)
        reached = whole.position[:, joint]
        far = [reached.max(), reached.min()]
        ends = ends + wanted - (far if angle_rad > 0.0 else far[::-1])
    return whole.slowed(max(1.0, duration_s / whole.duration_s))


def _through(machine: Machine, limits: Limits, nodes: list[Float]) -> JointTrajectory:
    if len(nodes) == 2:
        return time_line(machine.arm_names, nodes[0], nodes[1], limits)
    path = path_through(
        np.array(nodes), np.zeros(len(nodes) - 1, dtype=bool), limits.velocity, limits.acceleration
    )
    return time_path(machine.arm_names, path, limits)
