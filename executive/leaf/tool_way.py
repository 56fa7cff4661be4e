"""The way of the tool along a motion, and a motion that is slow at the end of it."""

import numpy as np

from executive.arrays import Float
from executive.machine.machine import Machine
from executive.messages.trajectory import JointTrajectory

_STEP_S = 0.02  # of the samples of the new trajectory
_SAME_S = 1e-9


def tool_way(machine: Machine, trajectory: JointTrajectory) -> Float:
    """Return the way of the grasp centre at each sample of a motion [m], from 0, shape (m,)."""
    from executive.machine.kinematics import Kinematics  # reading a mission imports it not

    kinematics = Kinematics(machine)
    places = np.array([kinematics.gripper(q)[:3, 3] for q in trajectory.position])
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])


def slow_at_the_end(
    trajectory: JointTrajectory,
    passed_m: Float,
    slow_m: float,
    speed_m_s: float,
    braking_m_s2: float,
) -> JointTrajectory:
    """Return the same path whose tool moves no faster than a speed on the last part of it.

    Before that part it brakes evenly. What is slower already stays as it is.

    Args:
        trajectory: A motion.
        passed_m: Way of the tool at each of its samples [m], as `tool_way` returns it.
        slow_m: Length of the last part [m].
        speed_m_s: Largest speed of the tool there [m/s].
        braking_m_s2: Deceleration of the tool before it [m/s²].
    """
    steps_m, steps_s = np.diff(passed_m), np.diff(trajectory.times_s)
    middle_m = passed_m[1:] - steps_m / 2
    before_m = np.maximum(passed_m[-1] - slow_m - middle_m, 0.0)
    most_m_s = np.sqrt(speed_m_s**2 + 2 * braking_m_s2 * before_m)
    lasts_s = np.maximum(steps_s, steps_m / most_m_s)
    if (lasts_s <= steps_s + _SAME_S).all():
        return trajectory
    stamps = np.concatenate([[0.0], np.cumsum(lasts_s)])
    new = np.linspace(0.0, stamps[-1], max(4, int(np.ceil(stamps[-1] / _STEP_S))) + 1)
    position = np.stack([np.interp(new, stamps, one) for one in trajectory.position.T], axis=1)
    velocity = np.gradient(position, new, axis=0)
    velocity[[0, -1]] = 0.0
    return JointTrajectory(trajectory.names, new, position, velocity)
