"""Constraints from the state estimate, and node poses before the graph has answered."""

import numpy as np
import pytest
from executive_plugins.mapping.node_track import NodeTrack
from executive_plugins.mapping.odometry_noise import OdometryNoise
from executive_plugins.mapping.pair_graph import Poses
from executive_plugins.mapping.settings import OdometryNoiseSettings

from executive.geometry.pose import pose

P = np.diag(np.repeat([0.002**2, 0.005**2], 3))
SETTINGS = OdometryNoiseSettings(rotation_rad=0.001, position_m=0.004, correlation_s=2.0)
STEP = pose(t=np.array([0.1, 0.0, 0.0]))


def test_the_variance_of_increments_grows_up_to_the_sum_of_both_poses() -> None:
    noise = OdometryNoise(SETTINGS)
    short, long = (
        noise.increment(STEP, duration_s, P, P).covariance for duration_s in (0.25, 900.0)
    )
    assert np.sqrt(np.diag(short)) == pytest.approx([0.0005] * 3 + [0.002] * 3)
    np.testing.assert_allclose(long, 2 * P, atol=1e-11)


def test_a_correction_increases_the_variance_of_its_increment() -> None:
    corrected = OdometryNoise(SETTINGS).increment(STEP, 0.1, P, 100 * P).covariance
    assert np.sqrt(corrected[5, 5]) == pytest.approx(0.005 * np.sqrt(99), rel=0.01)


def test_anchors_with_a_common_error_have_the_weight_of_one() -> None:
    noise = OdometryNoise(SETTINGS)
    often = noise.anchor(STEP, 1.0, P).covariance
    np.testing.assert_allclose(
        often, 4 * P, rtol=1e-4
    )  # four seconds of such anchors are worth one pose
    np.testing.assert_allclose(noise.anchor(STEP, np.inf, P).covariance, P, rtol=1e-4)
    assert noise.anchor(STEP, np.inf, None).covariance[5, 5] == SETTINGS.unknown_position_m**2


def test_nodes_without_an_answer_follow_those_with_one() -> None:
    track = NodeTrack(10)
    for k in range(4):
        track.append(STEP, pose(t=np.array([0.1 * k, 0.0, 0.0])))
    track.take(Poses(0, np.array([pose(t=np.array([0.1 * k, 0.5, 0.0])) for k in range(2)])))
    np.testing.assert_allclose(track.pose_of(3)[:3, 3], [0.3, 0.5, 0.0])
    assert track.next_number == 4


def test_a_track_forgets_the_oldest() -> None:
    track = NodeTrack(3)
    for k in range(5):
        track.append(STEP, pose(t=np.array([0.1 * k, 0.0, 0.0])))
    assert track.next_number == 5
    assert track.poses().first == 2
    np.testing.assert_allclose(track.pose_of(4)[:3, 3], [0.4, 0.0, 0.0])
    track.take(
        Poses(0, np.array([pose(t=np.array([9.0, 0.0, 0.0]))] * 3))
    )  # 0 and 1 are gone, 2 is not
    np.testing.assert_allclose(track.pose_of(4)[:3, 3], [9.2, 0.0, 0.0])
