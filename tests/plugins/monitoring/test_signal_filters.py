"""Smoothing follows a signal and forgets spikes."""

import numpy as np
import pytest
from executive_plugins.monitoring.signal_filters import LowPass, RunningMedian


def test_the_median_waits_until_its_span_is_covered_and_ignores_a_spike() -> None:
    median = RunningMedian(0.2)
    values = [1.0] * 40
    values[30] = 50.0
    answers = [median.add(0.01 * i, value) for i, value in enumerate(values)]
    assert answers[:20] == [None] * 20
    assert set(answers[20:]) == {1.0}


def test_the_low_pass_reaches_63_percent_of_a_step_in_its_time_constant() -> None:
    low_pass = LowPass(0.5)
    low_pass.add(0.0, np.zeros(1))
    for i in range(1, 51):
        value, _ = low_pass.add(0.01 * i, np.ones(1))
    assert value[0] == pytest.approx(1 - np.exp(-1), abs=1e-9)


def test_the_low_pass_tells_the_rate_of_a_ramp() -> None:
    low_pass = LowPass(0.2)
    for i in range(300):
        _, rate = low_pass.add(0.01 * i, np.array([0.01 * i * 3.0]))
    assert rate[0] == pytest.approx(
        3.0, rel=0.05
    )  # sampled every 10 ms, the lag is half a sample short
