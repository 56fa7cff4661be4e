"""Fixes and prediction that contradict each other raise an alarm, as rarely by chance as stated."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm

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
