"""Chains of trajectories and their stretching."""

import numpy as np
import pytest
from executive_plugins.motion.sweep import chain

from executive.messages.trajectory import JointTrajectory


def piece(begin: float, end: float) -> JointTrajectory:
    position = np.array([[begin], [(begin + end) / 2], [end]])
    return JointTrajectory(
        ("a",),
        np.array([0.0, 1.0, 2.0]),
        position,
        np.array([[0.0], [0.75 * (end - begin)], [0.0]]),
    )


def test_a_chain_runs_one_after_the_other() -> None:
    whole = chain([piece(0.0, 1.0), piece(1.0, -1.0)])
    assert whole.duration_s == 4.0
    assert len(whole.times_s) == 5
    for t in (0.3, 1.7, 2.0):
        assert whole.at(t)[0] == pytest.approx(piece(0.0, 1.0).at(t)[0])
        assert whole.at(2.0 + t)[0] == pytest.approx(piece(1.0, -1.0).at(t)[0])


def test_a_slowed_trajectory_takes_the_same_path_in_more_time() -> None:
    slow = piece(0.0, 1.0).slowed(3.0)
    assert slow.duration_s == 6.0
    position, velocity = slow.at(1.5)
    assert position == pytest.approx(piece(0.0, 1.0).at(0.5)[0])
    assert velocity == pytest.approx(piece(0.0, 1.0).at(0.5)[1] / 3)
