"""The motion between keyframes: a body on a circle, sampled a hundred times a second."""

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


def test_it_ends_a_sample_before_the_last_keyframe_and_goes_no_farther(track: MotionTrack) -> None:
    assert track.span_s == pytest.approx((0.0, 2.99))
    turns, places = track.at(np.array([-5.0, 9.0]))
    first, last = keyframe(0.0), keyframe(2.99)
    np.testing.assert_allclose(places, [first.p_map_imu, last.p_map_imu], atol=5e-4)
    assert angle_between(turns.as_matrix()[1], last.R_map_imu) < 1e-6
