"""The motion between keyframes: a body on a circle, sampled a hundred times a second."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.calibration.motion_track import MotionTrack
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState

from executive.geometry.rotation import about_axis, angle_between

RATE_RAD_S, RADIUS_M, G = 0.5, 4.0, 9.81
UP = np.array([0.0, 0.0, 1.0])
# In body axes, x ahead: the centre of the circle is to the left.
FORCE = np.array([0.0, RATE_RAD_S**2 * RADIUS_M, G])
SPEED = RATE_RAD_S * RADIUS_M
Z = np.zeros(3)


def sample(stamp_s: float) -> Inertial:
    return Inertial(stamp_s, RATE_RAD_S * UP, FORCE, 0.01)


def keyframe(stamp_s: float) -> InertialState:
    angle = RATE_RAD_S * stamp_s
    R = about_axis(UP, angle)
    p = RADIUS_M * np.array([np.sin(angle), 1 - np.cos(angle), 0.0])
    return InertialState(sample(stamp_s), R, p, R @ [SPEED, 0.0, 0.0], Z, Z)


@pytest.fixture
def track() -> MotionTrack:
    buffer = SampleBuffer()
    for k in range(301):
        buffer.append(sample(k / 100))
    return MotionTrack([keyframe(s) for s in (0.0, 1.0, 2.0, 3.0)], buffer, G)


def test_between_keyframes_it_is_where_the_samples_lead(track: MotionTrack) -> None:
    stamps_s = np.array([0.0, 0.37, 1.0, 1.994, 2.5])
    turns, places = track.at(stamps_s)
    for R, p, stamp_s in zip(turns.as_matrix(), places, stamps_s, strict=True):
        true = keyframe(float(stamp_s))
        assert angle_between(R, true.R_map_imu) < 1e-6
        # Between samples of 10 ms a straight line is off by a t² / 8 at most, a tenth of a
        # millimetre; 0.63 s of integration adds about as much.
        assert np.linalg.norm(p - true.p_map_imu) < 5e-4


def test_it_ends_at_the_last_keyframe_and_goes_no_farther(track: MotionTrack) -> None:
    assert track.span_s == pytest.approx((0.0, 3.0))
    turns, places = track.at(np.array([-5.0, 9.0]))
    first, last = (keyframe(stamp_s) for stamp_s in track.span_s)
    np.testing.assert_allclose(places, [first.p_map_imu, last.p_map_imu], atol=5e-4)
    assert angle_between(turns.as_matrix()[1], last.R_map_imu) < 1e-6


def test_it_has_no_step_where_samples_do_not_lead_to_a_keyframe() -> None:
    buffer, off = SampleBuffer(), about_axis(UP, 0.02)
    for k in range(301):
        buffer.append(sample(k / 100))
    keyframes = [keyframe(float(k)) for k in range(4)]
    moved = keyframes[2].p_map_imu + [0.0, 0.3, 0.0]
    keyframes[2] = replace(keyframes[2], p_map_imu=moved, R_map_imu=off @ keyframes[2].R_map_imu)
    stamps_s = np.arange(1.0, 2.99, 0.001)
    turns, places = MotionTrack(keyframes, buffer, G).at(stamps_s)
    # Of the 0.3 m a millisecond takes a thousandth, beside 2 mm of the motion itself.
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() < 0.003
    assert (turns[:-1].inv() * turns[1:]).magnitude().max() < 0.001
    k = int(np.argmin(np.abs(stamps_s - 2.0)))
    np.testing.assert_allclose(places[k], moved, atol=2e-3)
    assert angle_between(turns[k].as_matrix(), keyframes[2].R_map_imu) < 2e-4
