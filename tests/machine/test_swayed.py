"""What a sway makes of a moment that changes."""

import numpy as np
import pytest

from executive.machine.swayed import swayed

STEP_S, PERIOD_S = 0.02, 0.8


def pressed(moment: np.ndarray, period_s: float = PERIOD_S) -> float:
    return float(swayed(moment[:, None], STEP_S, period_s).max())


def times_s(lasts_s: float) -> np.ndarray:
    return np.arange(0.0, lasts_s, STEP_S)


def test_a_moment_that_comes_on_at_once_presses_by_twice_as_much() -> None:
    assert pressed(np.ones(200)) == pytest.approx(1 + np.exp(-0.04 * np.pi), abs=0.03)


def test_one_that_comes_on_over_a_period_presses_by_hardly_more() -> None:
    assert pressed(np.minimum(times_s(4.0) / PERIOD_S, 1.0)) < 1.05


def test_one_that_changes_its_sign_within_half_a_period_presses_by_more_than_three_times() -> None:
    moment = np.concatenate([-np.ones(20), np.ones(20)])  # each for half a period
    assert 3.2 < pressed(moment) < 3.8


def test_what_a_short_motion_leaves_is_seen_after_its_end() -> None:
    moment = -np.ones(10)
    answer = swayed(moment[:, None], STEP_S, PERIOD_S)
    assert len(answer) == len(moment) + PERIOD_S / STEP_S
    assert answer[: len(moment)].max() <= 0.0 < 1.0 < answer.max()


def test_without_a_sway_the_moment_itself_presses() -> None:
    moment = np.sin(times_s(1.0))[:, None]
    np.testing.assert_array_equal(swayed(moment, STEP_S, 0.0), moment)
