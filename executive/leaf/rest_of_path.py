"""What is left of a trajectory for an arm that has stopped on it."""

import numpy as np

from executive.arrays import Float
from executive.messages.trajectory import JointTrajectory

_RESOLUTION_S = 0.02  # of the search along the path: at 0.5 rad/s, 10 mrad
_ON_PATH = 0.03  # [rad] or [m]: a servo's lasting error under load and half a step of the search
_RAMP_S = 1.0  # in which the motion takes up its speed again
_STEP_S = 0.05  # of the samples of the new trajectory


def rest_of(trajectory: JointTrajectory, position: Float) -> JointTrajectory | None:
    """Return a trajectory along the rest of a path, from rest; None if the arm is not on it.

    The path is the same, so it is free of what it was free of when it was planned. Its time is
    slowed down at the start: with s(t) the time on the old trajectory, ds/dt rises from 0 to 1
    within a second, and the speeds stay below those that were planned.

    Args:
        trajectory: What the arm was to follow.
        position: Where its joints are, at rest [rad] or [m], shape (n,).
    """
    count = max(2, round(trajectory.duration_s / _RESOLUTION_S) + 1)
    times = np.linspace(0.0, trajectory.duration_s, count)
    path = np.array([trajectory.at(time)[0] for time in times])
    away = np.abs(path - position).max(axis=1)
    if away.min() > _ON_PATH:
        return None
    begin_s = float(times[int(away.argmin())])
    left_s = trajectory.duration_s - begin_s
    ramp_s = min(_RAMP_S, 2 * left_s)
    lasts_s = max(left_s + ramp_s / 2, _STEP_S)
    stamps = np.linspace(0.0, lasts_s, max(2, round(lasts_s / _STEP_S) + 1))
    rate = np.clip(stamps / ramp_s, 0.0, 1.0) if ramp_s > 0 else np.ones_like(stamps)
    gone = np.where(stamps < ramp_s, stamps**2 / (2 * max(ramp_s, 1e-9)), stamps - ramp_s / 2)
    at = [trajectory.at(min(begin_s + s, trajectory.duration_s)) for s in gone]
    positions = np.array([one for one, _ in at])
    positions[0] = position
    velocities = np.array([slope for _, slope in at]) * rate[:, None]
    velocities[-1] = 0.0
    return JointTrajectory(trajectory.names, stamps, positions, velocities)
