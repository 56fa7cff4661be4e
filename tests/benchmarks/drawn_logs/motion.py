"""Motions of the bodies that carry sensors: on foot, by car, in the air, on an excavator."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from drawn_logs.smooth_noise import smooth_noise, smooth_step
from executive.arrays import Float

GRAVITY_M_S2 = 9.81
_START_S = 4.0  # from rest to the first speed


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """The true motion of a body, sampled evenly; map axes are east, north, up.

    Attributes:
        kind: How the body moves.
        stamps_s: Times [s], shape (N,).
        R_map_body: Orientation (x forward, y left, z up), shape (N, 3, 3).
        v_map: Velocity [m/s], shape (N, 3).
        p_map: Position [m], shape (N, 3).
        moves_from_s: Time at which the motion begins [s]; 0 if the body moves from the first
            sample.
    """

    kind: str
    stamps_s: Float
    R_map_body: Float
    v_map: Float
    p_map: Float
    moves_from_s: float


@dataclass(frozen=True, slots=True)
class _Course:
    """Times, and how far the body has begun to move, 0 to 1, at each."""

    times_s: Float
    share: Float
    rng: np.random.Generator


_Angles = tuple[Float, Float, Float]  # yaw, pitch, roll [rad], shapes (N,)


def _walking(course: _Course) -> tuple[_Angles, Float]:
    t, rng = course.times_s, course.rng
    speed = course.share * np.clip(1.2 + smooth_noise(rng, t, 0.5, 6.0), 0.0, None)
    yaw = rng.uniform(-np.pi, np.pi) + course.share * smooth_noise(rng, t, 1.5, 5.0)
    step_hz, swing = rng.uniform(1.6, 2.2), course.share * rng.uniform(0.05, 0.15)
    bounce = np.sin(2 * np.pi * step_hz * t)
    pitch = swing * bounce + 0.1 * smooth_noise(rng, t, 1.0, 3.0)
    roll = swing * np.sin(np.pi * step_hz * t) + 0.1 * smooth_noise(rng, t, 1.0, 3.0)
    up = 0.04 * 2 * np.pi * step_hz * np.cos(2 * np.pi * step_hz * t) * course.share
    return (yaw, pitch, roll), _level(speed, yaw, up)


def _driving(course: _Course) -> tuple[_Angles, Float]:
    t, rng = course.times_s, course.rng
    top = rng.uniform(3.0, 20.0)
    halts = 0.5 + 0.5 * np.tanh(4 * (1.0 + smooth_noise(rng, t, 0.8, 10.0)))
    speed = course.share * halts * (0.6 * top + smooth_noise(rng, t, 0.15 * top, 12.0))
    curvature = smooth_noise(rng, t, 0.25 / top, 6.0)
    yaw = rng.uniform(-np.pi, np.pi) + _integral(speed * curvature, t)
    acceleration = np.gradient(speed, t)
    pitch = -0.01 * acceleration + smooth_noise(rng, t, 0.02, 6.0)
    roll = 0.004 * speed**2 * curvature + smooth_noise(rng, t, 0.02, 6.0)
    return (yaw, pitch, roll), _level(speed, yaw, -np.tan(pitch) * speed)


def _flying(course: _Course) -> tuple[_Angles, Float]:
    t, rng = course.times_s, course.rng
    quickness = rng.uniform(1.0, 6.0)
    v = np.column_stack(
        [course.share * smooth_noise(rng, t, quickness * s, rng.uniform(3, 6)) for s in (1, 1, 0.4)]
    )
    a = np.gradient(v, t, axis=0)
    yaw = rng.uniform(-np.pi, np.pi) + course.share * smooth_noise(rng, t, 1.0, 5.0)
    forward = np.cos(yaw) * a[:, 0] + np.sin(yaw) * a[:, 1]
    left = -np.sin(yaw) * a[:, 0] + np.cos(yaw) * a[:, 1]
    thrust = GRAVITY_M_S2 + a[:, 2]
    return (yaw, np.arctan2(forward, thrust), np.arctan2(-left, thrust)), v


def _digging(course: _Course) -> tuple[_Angles, Float]:
    """The cabin of an excavator: it swings, drives a little, and sways as the arm works."""
    t, rng = course.times_s, course.rng
    drives = 0.5 + 0.5 * np.tanh(6 * smooth_noise(rng, t, 1.0, 15.0))
    speed = course.share * drives * rng.uniform(0.0, 1.2)
    heading = rng.uniform(-np.pi, np.pi) + _integral(speed * smooth_noise(rng, t, 0.15, 8.0), t)
    yaw = heading + course.share * smooth_noise(rng, t, rng.uniform(0.5, 1.5), 8.0)
    sway = course.share * rng.uniform(0.002, 0.02)
    pitch, roll = (sway * smooth_noise(rng, t, 1.0, 1.5) for _ in range(2))
    v = _level(speed, heading, np.zeros_like(t))
    # The sensor is beside the axis of the cabin, and sways with it.
    out, high = rng.uniform(0.2, 1.5), rng.uniform(1.5, 3.0)
    around = out * np.gradient(yaw, t)
    v[:, 0] += -np.sin(yaw) * around + high * np.gradient(pitch, t) * np.cos(yaw)
    v[:, 1] += np.cos(yaw) * around + high * np.gradient(pitch, t) * np.sin(yaw)
    return (yaw, pitch, roll), v


_KINDS: Mapping[str, Callable[[_Course], tuple[_Angles, Float]]] = {
    "foot": _walking,
    "car": _driving,
    "flyer": _flying,
    "excavator": _digging,
}
KINDS = tuple(_KINDS)


def draw_motion(
    kind: str, rng: np.random.Generator, duration_s: float, rate_hz: float, rests_s: float
) -> Motion:
    """Draw a motion.

    Args:
        kind: One of `KINDS`.
        rng: Source of randomness.
        duration_s: Length [s].
        rate_hz: Samples a second [Hz].
        rests_s: Time at rest before the motion begins [s]; 0 for a body that moves from the first
            sample.
    """
    times_s = np.arange(round(duration_s * rate_hz) + 1) / rate_hz
    share = smooth_step(times_s, rests_s, _START_S) if rests_s > 0 else np.ones_like(times_s)
    (yaw, pitch, roll), v_map = _KINDS[kind](_Course(times_s, share, rng))
    R = Rotation.from_euler("ZYX", np.column_stack([yaw, pitch, roll])).as_matrix()
    p_map = np.column_stack([_integral(v_map[:, i], times_s) for i in range(3)])
    return Motion(kind, times_s, R, v_map, p_map, rests_s)


def _level(speed: Float, yaw: Float, up: Float) -> Float:
    return np.column_stack([speed * np.cos(yaw), speed * np.sin(yaw), up])


def _integral(values: Float, times_s: Float) -> Float:
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(times_s)
    return np.concatenate([[0.0], np.cumsum(steps)])
