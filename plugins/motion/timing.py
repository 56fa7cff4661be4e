"""Timing of a path within velocity, acceleration and jerk limits of all joints, twice smooth."""

from dataclasses import dataclass, replace

import numpy as np
from executive_plugins.motion.oil_flow import OilFlow
from executive_plugins.motion.path import HermitePath
from executive_plugins.motion.path_speeds import path_speeds

from executive.arrays import Float
from executive.messages.trajectory import JointTrajectory

PERIOD_S = 0.03  # between samples of the trajectory
_AT_REST = 2  # further control points before and after: three equal ones are a spline at rest


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """Velocity, acceleration and jerk limits of the joints, shape (n,) each, and of their oil.

    Attributes:
        velocity: Largest speed of each joint [rad/s, or m/s].
        acceleration: The same of its acceleration [rad/s², or m/s²].
        jerk: The same of its jerk [rad/s³, or m/s³].
        flow: What all joints together may take from a pump; None if nothing limits that.
        least_average_s: Least time over which a motion is averaged [s].
    """

    velocity: Float
    acceleration: Float
    jerk: Float
    flow: OilFlow | None = None
    least_average_s: float = 0.0

    def softened(self, share: float) -> "Limits":
        """Return limits with a share of the accelerations and jerks."""
        return replace(self, acceleration=share * self.acceleration, jerk=share * self.jerk)


def time_path(names: tuple[str, ...], path: HermitePath, limits: Limits) -> JointTrajectory:
    """Return a trajectory along a path, from rest to rest, with continuous acceleration.

    1. The fastest motion within velocity, flow and acceleration limits is sampled
       (`path_speeds`).
    2. A moving average over a time T replaces each sample. Averages of positions have averages of
       velocities and accelerations, so the limits still hold, and no joint leaves its range. The
       jerk of a joint becomes (a(t) − a(t − T)) / T; T is the shortest that keeps every jerk limit.
    3. The averages are the control points of a uniform cubic B-spline. Its velocity, acceleration
       and jerk are combinations of the points' differences, so that the limits hold at all times,
       not at samples only. Between samples of position and velocity it is the cubic Hermite curve
       that a `JointTrajectory` stands for.

    The motion takes T and a period longer than the fastest one without jerk limits.

    Deviation from the path: the average of a curve lies beside it where a joint accelerates, by at
    most (T² / 24 + period² / 6) × acceleration: for M545 6 mrad, and nothing on a straight line in
    joint space or at the ends. Collisions are therefore checked on the trajectory.

    Source: Biagiotti and Melchiorri, "FIR filters for online trajectory planning with time- and
    frequency-domain specifications", Control Engineering Practice 2012, Sec. 2, applied after the
    time-optimal parameterisation instead of to steps.
    """
    samples = _samples(path, limits)
    points = _averaged(samples, _window(samples, limits))
    ends = (_AT_REST, _AT_REST)
    points = np.pad(points, (ends, (0, 0)), mode="edge")
    position = (points[:-2] + 4 * points[1:-1] + points[2:]) / 6
    velocity = (points[2:] - points[:-2]) / (2 * PERIOD_S)
    position[[0, -1]] = points[[0, -1]]
    factor = _excess(points, limits)
    times_s = np.linspace(0.0, (len(position) - 1) * PERIOD_S * factor, len(position))
    return JointTrajectory(names, times_s, position, velocity / factor)


def _samples(path: HermitePath, limits: Limits) -> Float:
    """Return positions of the fastest motion without jerk limits, a period apart, shape (m, n)."""
    u, squares = path_speeds(path, limits.velocity, limits.acceleration, limits.flow)
    speeds = np.sqrt(squares)
    times = np.concatenate([[0.0], np.cumsum(2 * np.diff(u) / (speeds[1:] + speeds[:-1]))])
    count = max(1, int(np.ceil(times[-1] / PERIOD_S)))
    at = np.linspace(0.0, times[-1], count + 1)
    i = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(u) - 2)
    gain = np.diff(squares) / (2 * np.diff(u))
    passed = at - times[i]
    reached = u[i] + speeds[i] * passed + gain[i] * passed**2 / 2
    reached[-1] = u[-1]
    return path.position(np.clip(reached, 0.0, u[-1]))


def _window(samples: Float, limits: Limits) -> int:
    """Return over how many samples to average, so that all jerk limits hold."""
    longest = int(np.ceil(2 * (limits.acceleration / limits.jerk).max() / PERIOD_S)) + 1
    around = np.pad(samples, ((longest + 1, longest + 1), (0, 0)), mode="edge")
    acceleration = np.diff(around, 2, axis=0) / PERIOD_S**2
    least = max(1, round(limits.least_average_s / PERIOD_S))
    for window in range(least, longest):
        change = np.abs(acceleration[window:] - acceleration[:-window])
        if (change <= limits.jerk * window * PERIOD_S).all():
            return window
    return max(least, longest)


def _averaged(samples: Float, window: int) -> Float:
    """Return averages over windows that begin at the first sample alone and end at the last."""
    around = np.pad(samples, ((window, window - 1), (0, 0)), mode="edge")
    sums = np.cumsum(around, axis=0)
    averages = (sums[window:] - sums[:-window]) / window
    averages[0], averages[-1] = samples[0], samples[-1]
    return np.asarray(averages)


def _excess(points: Float, limits: Limits) -> float:
    """Return the factor on time, at least 1, that removes what rounding leaves above a limit."""
    above = [
        (np.abs(np.diff(points, order, axis=0)) / PERIOD_S**order / limit).max() ** (1 / order)
        for order, limit in enumerate((limits.velocity, limits.acceleration, limits.jerk), start=1)
    ]
    if limits.flow is not None:
        above.append(float(1.0 / limits.flow.fastest(np.diff(points, axis=0) / PERIOD_S).min()))
    return float(max(1.0, *above))
