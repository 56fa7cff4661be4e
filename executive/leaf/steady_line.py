"""Time a straight line anew, with a constant speed between two soft ends."""

import numpy as np

from executive.arrays import Float
from executive.messages.trajectory import JointTrajectory

_STEP_S = 0.02  # of the samples of the new trajectory
_STILL_M = 1e-6  # a shorter step of the line is none: distances must rise


def steady_line(
    trajectory: JointTrajectory, passed_m: Float, speed_m_s: float, ramp_s: float
) -> JointTrajectory:
    """Return a motion over the same postures whose tool moves at a constant speed.

    The speed rises along 3u² − 2u³ within the ramp, and falls so before the end. A line that is
    too short for both ramps is slower throughout. The tool is slower where a joint would be faster
    than anywhere in the given motion, which keeps the joints' limits: an arm with more joints than
    the tool needs may change its posture while the tool hardly moves.

    Args:
        trajectory: A motion of the tool along a line, without a way back.
        passed_m: Way of the tool at each of its samples [m], rising from 0, shape (m,).
        speed_m_s: Speed between the ramps [m/s].
        ramp_s: Time of each ramp [s].
    """
    paced_m = _paced(trajectory, passed_m, speed_m_s)
    rises = np.insert(np.diff(paced_m) > _STILL_M, 0, True)
    way, postures = paced_m[rises], trajectory.position[rises]
    total_m = float(way[-1])
    if total_m < _STILL_M:
        return trajectory
    speed_m_s = min(speed_m_s, total_m / ramp_s)  # each ramp takes half of a ramp at full speed
    lasts_s = total_m / speed_m_s + ramp_s
    stamps = np.linspace(0.0, lasts_s, max(4, int(np.ceil(lasts_s / _STEP_S))) + 1)
    gone = speed_m_s * (_ramped(stamps, ramp_s) - _ramped(stamps - (lasts_s - ramp_s), ramp_s))
    position = np.stack([np.interp(gone, way, joint) for joint in postures.T], axis=1)
    position[-1] = trajectory.position[-1]
    velocity = np.gradient(position, stamps, axis=0)
    velocity[[0, -1]] = 0.0
    return JointTrajectory(trajectory.names, stamps, position, velocity)


def _paced(trajectory: JointTrajectory, passed_m: Float, speed_m_s: float) -> Float:
    """Return the way [m], (m,): of the tool, or what it would pass in the time a joint needs."""
    fastest = np.abs(trajectory.velocity).max(axis=0)
    moves = fastest > 0.0
    steps = np.abs(np.diff(trajectory.position, axis=0))[:, moves]
    least_s = (steps / fastest[moves]).max(axis=1, initial=0.0)
    steps_m = np.maximum(np.diff(passed_m), speed_m_s * least_s)
    return np.asarray(np.insert(np.cumsum(steps_m), 0, 0.0))


def _ramped(time_s: Float, ramp_s: float) -> Float:
    """Return the integral of a speed that rises from 0 to 1 within a ramp [s], shape (k,)."""
    u = np.clip(time_s / ramp_s, 0.0, 1.0)
    return np.asarray(ramp_s * (u**3 - u**4 / 2) + np.maximum(time_s - ramp_s, 0.0))
