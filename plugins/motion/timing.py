"""Timing of a path: jerk-limited profiles by Ruckig, within the limits of all joints."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import ruckig
from executive_plugins.motion.path import HermitePath

from executive.arrays import Float
from executive.errors import DataError
from executive.messages.trajectory import JointTrajectory

_GRID = 0.02  # step of the parameter, about 20 ms
_CURVED = 0.5  # share of the acceleration limit for curvature; the rest changes the speed
_ALIKE = 1.35  # windows whose speed limits differ by a smaller factor form one stretch
_STRETCH = 0.4  # shortest stretch, in the parameter
_STILL = 1e-3  # least slope and curvature
_PERIOD_S = 0.03  # between samples of the trajectory


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """Velocity, acceleration and jerk limits of the joints, shape (n,) each."""

    velocity: Float
    acceleration: Float
    jerk: Float


@dataclass(frozen=True, slots=True)
class _Stretch:
    """An interval of the path with one limit on the parameter's velocity, acceleration and jerk."""

    begin: float
    end: float
    velocity: float
    acceleration: float
    jerk: float


def time_path(names: tuple[str, ...], path: HermitePath, limits: Limits) -> JointTrajectory:
    """Return a trajectory along a path, from rest to rest.

    The speed of the parameter follows a chain of one-dimensional Ruckig profiles, one per stretch.
    The speeds between stretches are lowered until each stretch is long enough for its change of
    speed (a backward and a forward pass). Finally time is scaled evenly so that the joint closest
    to its limit reaches it exactly: velocity and acceleration limits hold regardless of the
    approximations before. The jerk limit shapes the profiles; it is not enforced on the joints.
    """
    stretches = _stretches(path, limits)
    times, u, rates = _profile(stretches, _end_speeds(stretches))
    position, velocity = path.position(u), path.tangent(u) * rates[:, None]
    velocity[[0, -1]] = 0.0
    factor = _excess(times, position, velocity, limits)
    return JointTrajectory(names, times * factor, position, velocity / factor)


def accelerations(times_s: Float, position: Float, velocity: Float) -> Float:
    """Return accelerations of the cubic curve at both ends of each interval, (m − 1, 2, n)."""
    h = np.diff(times_s)[:, None]
    secant = np.diff(position, axis=0) / h
    before, after = velocity[:-1], velocity[1:]
    ends = [(6 * secant - 4 * before - 2 * after) / h, (-6 * secant + 2 * before + 4 * after) / h]
    return np.stack(ends, axis=1)


def _excess(times_s: Float, position: Float, velocity: Float, limits: Limits) -> float:
    """Return the factor on time with which the joint closest to its limit reaches it exactly."""
    too_fast = float((np.abs(velocity) / limits.velocity).max())
    too_hard = float(
        (np.abs(accelerations(times_s, position, velocity)) / limits.acceleration).max()
    )
    return float(max(too_fast, np.sqrt(too_hard), 1e-3)) * (1 + 1e-9)


def _stretches(path: HermitePath, limits: Limits) -> list[_Stretch]:
    u = np.linspace(0.0, path.length, max(8, int(path.length / _GRID)))
    # The least slope and curvature bound the parameter speed where hardly any joint moves.
    slope, bend = np.abs(path.tangent(u)) + _STILL, np.abs(path.curvature(u)) + _STILL
    speed = np.minimum(
        (limits.velocity / slope).min(axis=1),
        np.sqrt((_CURVED * limits.acceleration / bend).min(axis=1)),
    )
    gain = ((1 - _CURVED) * limits.acceleration / slope).min(axis=1)
    jerk = (limits.jerk / slope).min(axis=1)
    cuts = _cuts(speed, max(2, int(_STRETCH / _GRID)))
    return [
        _Stretch(
            float(u[i]), float(u[j]), *(float(v[i : j + 1].min()) for v in (speed, gain, jerk))
        )
        for i, j in pairwise(cuts)
    ]


def _cuts(speed: Float, window: int) -> list[int]:
    """Return grid indices that separate windows with different speed limits."""
    last = len(speed) - 1
    starts = [*range(0, max(last - window, 0) + 1, window)]
    least = [speed[i : j + 1].min() for i, j in zip(starts, [*starts[1:], last], strict=True)]
    cuts, low, high = [0], least[0], least[0]
    for start, value in zip(starts[1:], least[1:], strict=True):
        low, high = min(low, value), max(high, value)
        if high > _ALIKE * low:
            cuts.append(start)
            low = high = value
    return [*cuts, last]


def _end_speeds(stretches: list[_Stretch]) -> list[float]:
    """Return the parameter's speed at the ends of all stretches, 0 at the first and the last."""
    inner = [min(a.velocity, b.velocity) for a, b in pairwise(stretches)]
    speeds = [0.0, *inner, 0.0]
    for i in reversed(range(len(stretches))):
        speeds[i] = min(speeds[i], _fastest(speeds[i + 1], stretches[i]))
    for i in range(len(stretches)):
        speeds[i + 1] = min(speeds[i + 1], _fastest(speeds[i], stretches[i]))
    return speeds


def _fastest(speed: float, stretch: _Stretch) -> float:
    """Return the highest speed reachable within a stretch, without acceleration at its ends."""
    low, high = speed, max(speed, stretch.velocity)
    for _ in range(30):
        middle = (low + high) / 2
        if _distance(speed, middle, stretch) <= 0.98 * (stretch.end - stretch.begin):
            low = middle
        else:
            high = middle
    return low


def _distance(speed: float, faster: float, stretch: _Stretch) -> float:
    gain, a, j = faster - speed, stretch.acceleration, stretch.jerk
    time = gain / a + a / j if gain >= a * a / j else 2 * np.sqrt(gain / j)
    return float((speed + faster) / 2 * time)


def _profile(stretches: list[_Stretch], speeds: list[float]) -> tuple[Float, Float, Float]:
    """Return times (m,), parameters (m,) and their rates (m,) of the chained profiles."""
    profiles = [_ruckig(s, speeds[i], speeds[i + 1]) for i, s in enumerate(stretches)]
    starts = np.concatenate([[0.0], np.cumsum([profile.duration for profile in profiles])])
    times = np.linspace(0.0, starts[-1], max(2, int(np.ceil(starts[-1] / _PERIOD_S)) + 1))
    which = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(profiles) - 1)
    states = [profiles[i].at_time(t - starts[i]) for i, t in zip(which, times, strict=True)]
    u = np.clip([state[0][0] for state in states], 0.0, stretches[-1].end)
    return times, u, np.array([state[1][0] for state in states])


def _ruckig(stretch: _Stretch, begin_speed: float, end_speed: float) -> ruckig.Trajectory:
    wanted = ruckig.InputParameter(1)
    wanted.current_position, wanted.target_position = [stretch.begin], [stretch.end]
    wanted.current_velocity, wanted.target_velocity = [begin_speed], [end_speed]
    wanted.max_velocity, wanted.max_acceleration = [stretch.velocity], [stretch.acceleration]
    wanted.max_jerk = [stretch.jerk]
    profile = ruckig.Trajectory(1)
    result = ruckig.Ruckig(1).calculate(wanted, profile)
    if result != ruckig.Result.Working:
        raise DataError(
            f"no timing from {begin_speed:.3f} to {end_speed:.3f} over {stretch}: {result}"
        )
    return profile
