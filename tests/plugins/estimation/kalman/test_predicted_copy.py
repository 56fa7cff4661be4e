"""A copy of before a doubt agrees with fixes that have come back, and with no others."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import DIMENSION, Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from executive_plugins.estimation.kalman.predicted_copy import PredictedCopy
from executive_plugins.estimation.live.layout import SAMPLE

Z, UP = np.zeros(3), np.array([0.0, 0.0, 9.81])
NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
FIX_STD_M, COUNT = 0.02, 2000  # samples of 0.01 s
RING = np.zeros(COUNT, SAMPLE)
for k in range(COUNT):
    RING[k] = (k + 1) / 100, 0.01, Z, UP


def body(velocity_std_m_s: float, x_m: float = 0.0) -> ErrorStateFilter:
    """Return a filter of a body at rest at x whose velocity is known so well."""
    P = np.diag(np.repeat([1e-8, velocity_std_m_s**2, FIX_STD_M**2 / 10, 1e-12, 1e-12], 3))
    assert P.shape == (DIMENSION, DIMENSION)
    state = InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), np.array([x_m, 0.0, 0.0]), Z, Z, Z)
    return ErrorStateFilter(state, P, NOISE)


DRAWN_ALONG = body(0.01, 9.0)


def agreed(
    copy: PredictedCopy,
    at_s: float,
    x_m: float,
    scale: float = 1.0,
    kalman: ErrorStateFilter = DRAWN_ALONG,
) -> int:
    """Hold a fix at x against the copy and a filter; return how many agree with the copy."""
    fix = Fix(at_s, "antenna", Z, np.array([x_m, 0.0, 0.0]), FIX_STD_M**2 * np.eye(3))
    copy.add_fix(fix, scale, 0.0)
    copy.predict_until(RING, COUNT, at_s)
    fix_residual(kalman, fix, 0.0)
    return copy.take(kalman, fix, scale, 0.0)


def test_fixes_that_come_back_agree_one_by_one_and_correct_the_state() -> None:
    kalman = body(0.01)
    copy = PredictedCopy(kalman, 0)
    assert [agreed(copy, t, 1.0) for t in (0.1, 0.2, 0.3)] == [0, 0, 0]
    assert [agreed(copy, t, 0.01) for t in (0.4, 0.5, 0.6)] == [1, 2, 3]
    copy.replace(kalman)
    assert kalman.stamp_s == pytest.approx(0.6)
    assert 0.0 < kalman.state.p_map_imu[0] < 0.02
    assert np.sqrt(kalman.covariance[6, 6]) < FIX_STD_M


def test_fixes_that_were_never_refuted_are_no_reason_to_return() -> None:
    copy = PredictedCopy(body(0.01), 0)
    assert [agreed(copy, t, 0.01) for t in (0.1, 0.2, 0.3, 0.4)] == [0, 0, 0, 0]


def test_a_copy_that_has_become_uncertain_does_not_agree_with_what_it_refuted() -> None:
    """After two seconds its velocity explains the jump; only a step back is evidence then."""
    copy = PredictedCopy(body(1.0), 0)
    assert agreed(copy, 0.05, 1.0) == 0
    assert [agreed(copy, t, 1.0) for t in (2.0, 2.05, 2.1)] == [0, 0, 0]
    assert [agreed(copy, t, 0.0) for t in (2.15, 2.2, 2.25)] == [1, 2, 3]


@pytest.mark.parametrize("by_m", [0.0, -0.3])
def test_a_small_step_back_is_told_by_two_fixes_before_it(by_m: float) -> None:
    """The copy's velocity is known to 1 m/s: a drift as large is no step, and hides none."""
    copy, drift_m_s, kalman = PredictedCopy(body(1.0), 0), 0.5, body(0.01, 9.0)
    assert agreed(copy, 0.05, 0.3 + drift_m_s * 0.05) == 0
    stamps_s = np.arange(40, 81) / 10
    assert max(agreed(copy, t, 0.3 + drift_m_s * t, 1.0, kalman) for t in stamps_s) == 0
    after = [agreed(copy, t, 0.3 + drift_m_s * t + by_m, 1.0, kalman) for t in (8.1, 8.2, 8.3)]
    assert after == ([1, 2, 3] if by_m else [0, 0, 0])


def test_a_fix_that_comes_twice_is_no_step() -> None:
    copy = PredictedCopy(body(1.0), 0)
    assert [agreed(copy, t, 0.3) for t in (0.05, 2.0, 2.1, 2.1)] == [0, 0, 0, 0]


@pytest.mark.parametrize("seed", range(8))
def test_noise_at_the_limit_does_not_bring_fixes_back(seed: int) -> None:
    """The covariance grows past a jump that stays, and the noise crosses the limit both ways."""
    rng, copy = np.random.default_rng(seed), PredictedCopy(body(0.1), 0)
    stamps_s = np.arange(1, 121) / 20
    counts = [agreed(copy, t, 0.5 + rng.normal(0, FIX_STD_M)) for t in stamps_s]
    assert max(counts) == 0
    assert [agreed(copy, t, 0.0) for t in (6.05, 6.1, 6.15)] == [1, 2, 3]


def test_noisy_fixes_agree_with_the_copy_but_not_with_one_another() -> None:
    copy = PredictedCopy(body(1.0), 0)
    assert agreed(copy, 0.05, 2.0) == 0
    counts = [agreed(copy, 1.0 + 0.05 * k, 0.4 * (-1) ** k) for k in range(12)]
    assert max(counts) == 1
    # The same scatter is nothing unusual for a sensor that was known to err by so much.
    copy = PredictedCopy(body(1.0), 0)
    assert agreed(copy, 0.05, 9.0, 400.0) == 0
    assert max(agreed(copy, 1.0 + 0.05 * k, 0.4 * (-1) ** k, 400.0) for k in range(12)) == 12


def test_a_filter_that_makes_fixes_as_likely_keeps_its_state() -> None:
    """It has refused the wrong fixes, and knows better than the copy where it is."""
    for filter_m, returns in ((0.0, False), (0.5, True)):
        copy = PredictedCopy(body(1.0), 0)
        agreed(copy, 0.1, 9.0)
        right = body(0.01, filter_m)
        assert any(agreed(copy, t, 0.0, 1.0, right) for t in (0.2, 0.25, 0.3)) == returns


def test_a_fix_that_agrees_with_the_filter_begins_the_count_again() -> None:
    copy = PredictedCopy(body(0.01), 0)
    agreed(copy, 0.1, 1.0)
    assert [agreed(copy, t, 0.0) for t in (0.2, 0.3)] == [1, 2]
    copy.disagree()
    assert agreed(copy, 0.4, 0.0) == 1
