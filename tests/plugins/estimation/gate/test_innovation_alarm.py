"""Fixes and prediction that contradict each other raise an alarm, as rarely by chance as stated."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm, binary
from scipy.stats import chi2

COVARIANCE, GATE = 1e-4 * np.eye(3), 60.0


def alarms_of(innovations, period_s=0.1):
    alarm = InnovationAlarm(3)
    for innovation in innovations:
        alarm.add(innovation, COVARIANCE, GATE, period_s)
        yield alarm.is_raised


def test_white_innovations_of_an_hour_raise_a_few_alarms_at_most() -> None:
    rng = np.random.default_rng(1)
    raised = np.array(list(alarms_of(rng.normal(0, 0.01, (3600, 3)), period_s=1.0)))
    begun = np.count_nonzero(raised[1:] & ~raised[:-1])
    assert begun <= 4  # the mean is one; more than four come in one hour of 270


@pytest.mark.parametrize(("shift_sigmas", "within"), [(6.0, 1), (4.0, 4), (3.0, 6)])
def test_a_shift_raises_one_and_a_large_one_at_once(shift_sigmas: float, within: int) -> None:
    rng = np.random.default_rng(2)
    shifted = rng.normal(0, 0.003, (6, 3)) + [0.01 * shift_sigmas, 0.0, 0.0]
    assert any(list(alarms_of(shifted))[:within])


def test_it_ends_when_innovations_are_usual_again() -> None:
    jump = [np.array([0.1, 0.0, 0.0])]
    usual = list(np.random.default_rng(3).normal(0, 0.005, (9, 3)))
    assert not list(alarms_of([*jump, *usual]))[-1]


def test_one_outlier_is_no_evidence_of_more_than_itself() -> None:
    usual = list(np.random.default_rng(4).normal(0, 0.005, (3, 3)))
    assert not list(alarms_of([np.array([100.0, 0.0, 0.0]), *usual]))[-1]


X, Y, ZERO = 0.01 * np.eye(3)[0], 0.01 * np.eye(3)[1], np.zeros(3)  # a standard deviation each
# Of a period of 0.1 s the next power of two is 1/16 s: one chance in an hour, of six windows.
LIMIT = np.sqrt(chi2.isf(0.0625 / (3600 * 6), 3))


@pytest.mark.parametrize("count", [1, 2, 6])
def test_a_mean_of_up_to_six_is_bounded(count: int) -> None:
    """The sum of equal ones counts over the root of their number."""
    for factor, is_raised in ((0.999, False), (1.001, True)):
        size = factor * LIMIT / np.sqrt(count)
        raised = list(alarms_of([ZERO, *[size * X] * count]))
        assert raised == [False] * count + [is_raised]
    seven = [0.999 * LIMIT / np.sqrt(6) * X] * 9  # a seventh is too old
    assert not any(alarms_of(seven))


def test_the_bound_follows_the_period_in_powers_of_two() -> None:
    periods = (0.0, 1e-3, 0.1, 0.125, 0.2, 1.0, 50.0, 1e3)
    expected = [2.0**-10, 2.0**-10, 0.0625, 0.125, 0.125, 1.0, 32.0, 32.0]
    assert [binary(period_s) for period_s in periods] == expected
    jump = [0.999 * LIMIT * X]
    assert not any(alarms_of(jump, 0.1))
    assert any(alarms_of(jump, 0.2))


@pytest.mark.parametrize(("factor", "is_raised"), [(0.99, False), (1.01, True)])
def test_an_outlier_counts_as_much_as_the_gate(factor: float, is_raised: bool) -> None:
    alarm = InnovationAlarm(3)
    alarm.add(99 * X, COVARIANCE, factor * LIMIT**2, 0.1)
    assert alarm.is_raised == is_raised


def test_three_that_are_usual_in_the_mean_end_an_alarm() -> None:
    """Their squared mean is below the 95 % quantile."""
    jump, usual = 1.001 * LIMIT * Y, np.sqrt(chi2.ppf(0.95, 3) / 3)
    assert list(alarms_of([jump, ZERO, ZERO, ZERO])) == [True, True, True, False]
    assert list(alarms_of([jump, *[0.999 * usual * X] * 3])) == [True, True, True, False]
    assert list(alarms_of([jump, *[1.001 * usual * X] * 3, ZERO])) == [True] * 4 + [False]
    # A new jump begins the count anew.
    again = list(alarms_of([jump, ZERO, ZERO, 1.1 * jump, ZERO, ZERO, ZERO]))
    assert again == [True] * 6 + [False]


def test_innovations_count_in_their_covariance_and_nothing_unknown_does() -> None:
    root = np.array([[0.02, 0.0, 0.0], [0.01, 0.03, 0.0], [-0.02, 0.01, 0.05]])
    for factor, is_raised in ((0.999, False), (1.001, True)):
        alarm = InnovationAlarm(3)
        alarm.add(np.full(3, np.nan), root @ root.T, GATE, 0.1)
        alarm.add(factor * LIMIT * root @ [0.6, 0.0, -0.8], root @ root.T, GATE, 0.1)
        assert alarm.is_raised == is_raised
