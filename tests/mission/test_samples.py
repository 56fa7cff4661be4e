"""Wall times of a long run take bounded memory."""

import numpy as np

from executive.mission.record.samples import Samples


def test_a_long_run_keeps_a_part_that_is_spread_evenly():
    samples = Samples()
    for value in range(500_000):
        samples.append(float(value))
    assert samples.total == 500_000
    assert len(samples) <= 20_000
    assert abs(np.median(list(samples)) - 250_000) < 100


def test_a_short_run_keeps_all():
    samples = Samples()
    for value in (3.0, 1.0):
        samples.append(value)
    assert (list(samples), samples.total) == ([3.0, 1.0], 2)
