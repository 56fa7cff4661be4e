"""Measures of compared estimators: steps of the odometry frame, recovery after an outage."""

from dataclasses import replace

import numpy as np
import pytest

from executive.errors import DataError
from executive.estimate.compare import odometry_steps, side_by_side, table
from executive.estimate.measures import Track
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis

UP = np.array([0.0, 0.0, 1.0])
SPEED = np.array([0.7, -0.2, 0.1])


@pytest.fixture
def even() -> Track:
    """A hundred states at 100 Hz of a body at constant velocity; map and odometry agree."""
    stamps = 0.01 * np.arange(100)
    poses = np.array([pose(about_axis(UP, 0.4), t * SPEED) for t in stamps])
    return Track(stamps, poses, poses, poses, np.tile(SPEED, (100, 1)), np.zeros((100, 3)))


def test_constant_velocity_has_no_steps(even: Track) -> None:
    assert odometry_steps(even).max() < 1e-12


def test_a_correction_of_the_map_is_no_step_of_the_odometry(even: Track) -> None:
    correction = pose(about_axis(UP, 0.3), np.array([2.0, 1.0, 0.0]))
    corrected = np.concatenate([even.T_map_base[:50], correction @ even.T_map_base[50:]])
    v = np.concatenate([even.v_map_cabin[:50], even.v_map_cabin[50:] @ correction[:3, :3].T])
    steps = odometry_steps(
        replace(even, T_map_base=corrected, T_map_cabin=corrected, v_map_cabin=v)
    )
    # at the correction itself half of the mean speed is still that before it
    assert np.delete(steps, 49).max() < 1e-12
    assert steps[49] < 0.01 * np.linalg.norm(SPEED)


def test_a_step_of_the_odometry_is_found_at_its_size(even: Track) -> None:
    stepped = even.T_odom_base.copy()
    stepped[60:, :3, 3] += [0.0, 0.03, 0.04]
    steps = odometry_steps(replace(even, T_odom_base=stepped))
    assert steps.argmax() == 59
    assert steps.max() == pytest.approx(0.05)


REPORT = {
    "prediction_m": {"n": 0},
    "posterior_m": {"n": 0},
    "consistency_m": {"n": 0},
    "latency_us": {"n": 0},
    "odometry_step_m": 0.001,
    "replay_speed": 7.0,
    "outages": [],
    "truth": {},
}


def _run(name: str) -> dict:
    if name == "lost":
        raise DataError("log: lost found no first state")
    return REPORT


def test_an_estimator_that_finds_no_state_is_named_below_the_others() -> None:
    lines = table(side_by_side(["lost", "found"], _run)).splitlines()
    assert lines[0].split() == ["found"]
    assert lines[-1] == "lost: log: lost found no first state"


def test_it_is_an_error_if_none_finds_a_state() -> None:
    with pytest.raises(DataError, match="lost found no first state"):
        side_by_side(["lost"], _run)
