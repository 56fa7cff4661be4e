"""Timing of a straight line in joint space: the fastest motion within all limits, by Ruckig."""

from itertools import pairwise

import numpy as np
import ruckig
from executive_plugins.motion.timing import PERIOD_S, Limits

from executive.arrays import Float
from executive.errors import DataError
from executive.messages.trajectory import JointTrajectory

_STILL = 1e-9  # a shorter line counts as none [rad] or [m]
_SHORT_S = 1e-6  # a shorter phase is no phase


def time_line(names: tuple[str, ...], start: Float, goal: Float, limits: Limits) -> JointTrajectory:
    """Return the time-optimal motion from rest to rest along a straight line in joint space.

    All joints move in proportion, so that the share of the line that is done is the one degree of
    freedom that Ruckig times; its limits are those of the joint that is closest to its own, or of
    the oil that all of them take. The motion has up to seven phases of constant jerk. Each begins
    and ends at a sample, so that the cubic curves between samples are the motion itself and no
    limit is exceeded between them.

    Source: Berscheid and Kröger, "Jerk-limited real-time trajectory generation with arbitrary
    target states", RSS 2021.

    Args:
        names: The joints.
        start: Positions at the start [rad] or [m], shape (n,).
        goal: Positions at the end, shape (n,).
        limits: Limits of the joints.

    Raises:
        DataError: If Ruckig finds no motion.
    """
    line = goal - start
    if np.abs(line).max() < _STILL:
        rest = np.array([start, goal])
        return JointTrajectory(names, np.array([0.0, PERIOD_S]), rest, np.zeros(rest.shape))
    profile = _share(line, limits)
    times_s = _times(profile)
    states = [profile.at_time(time_s) for time_s in times_s]
    share, rate = (np.array([state[order][0] for state in states]) for order in (0, 1))
    share[-1], rate[0], rate[-1] = 1.0, 0.0, 0.0
    return JointTrajectory(names, times_s, start + share[:, None] * line, rate[:, None] * line)


def _share(line: Float, limits: Limits) -> ruckig.Trajectory:
    """Return the motion of the share of the line that is done, from 0 to 1."""
    moving = np.abs(line) >= _STILL
    velocity, acceleration, jerk = (
        float((limit[moving] / np.abs(line[moving])).min())
        for limit in (limits.velocity, limits.acceleration, limits.jerk)
    )
    if limits.flow is not None:
        velocity = min(velocity, float(limits.flow.fastest(line[None])[0]))
    wanted = ruckig.InputParameter(1)
    wanted.current_position, wanted.target_position = [0.0], [1.0]
    wanted.max_velocity, wanted.max_acceleration, wanted.max_jerk = (
        [velocity],
        [acceleration],
        [jerk],
    )
    profile = ruckig.Trajectory(1)
    result = ruckig.Ruckig(1).calculate(wanted, profile)
    if result != ruckig.Result.Working:
        raise DataError(f"no timing of a line with the limits {limits}: {result}")
    return profile


def _times(profile: ruckig.Trajectory) -> Float:
    """Return the times of samples: the ends of all phases, and between them at most a period."""
    ends = np.concatenate([[0.0], np.cumsum(profile.profiles[0][0].t)])
    ends = ends[np.insert(np.diff(ends) > _SHORT_S, 0, True)]
    pieces = [
        np.linspace(begin, end, max(1, int(np.ceil((end - begin) / PERIOD_S))), endpoint=False)
        for begin, end in pairwise(ends)
    ]
    return np.concatenate([*pieces, ends[-1:]])
