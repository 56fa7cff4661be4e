"""Letting dropped bodies come to rest in a MuJoCo world."""

import mujoco
import numpy as np

_STILL = 1e-3  # largest speed of a body at rest [m/s] and [rad/s]
# Soil absorbs the energy of rocking within about this time; rigid ground in MuJoCo does not [s].
_DAMPING_S = 0.5


def come_to_rest(model: mujoco.MjModel, data: mujoco.MjData, least_s: float, most_s: float) -> bool:
    """Step a world, with all velocities damped, until its bodies rest or the time is over.

    Args:
        model: The world; its bodies move freely.
        data: Its state; holds the poses at rest afterwards.
        least_s: Simulated time before which bodies do not count as resting [s].
        most_s: Simulated time at which to give up [s].

    Returns:
        Whether all bodies rest.
    """
    while data.time < least_s or (_speed(data) > _STILL and data.time < most_s):
        mujoco.mj_step(model, data)
        data.qvel *= 1 - model.opt.timestep / _DAMPING_S
    return _speed(data) <= _STILL


def _speed(data: mujoco.MjData) -> float:
    return float(np.abs(data.qvel).max(initial=0.0))
