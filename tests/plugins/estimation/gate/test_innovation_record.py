"""What one antenna's innovations show is forgotten with the state that they belong to."""

import numpy as np
from executive_plugins.estimation.gate.innovation_record import InnovationRecord, judge


def test_a_record_is_renewed_with_the_scale_of_before_the_alarm() -> None:
    rng, record = np.random.default_rng(4), InnovationRecord(22.0, 10.0, 1.0)
    record.expect(0.1)

    def take(now_s: float, off: float) -> None:
        residual = rng.normal(0, 2.0, 3) + off
        judge(record.block[0], residual, 1e-4 * np.eye(3), np.eye(3), now_s)

    for k in range(40):
        take(k / 10, 0.0)
    for k in range(40, 60):
        take(k / 10, 40.0)
    assert record.is_alarmed
    assert record.block[0]["middle"] > 20.0
    known = record.known_scale
    assert 2.0 < known < 8.0  # the variance is four times what is declared
    record.renew()
    assert not record.is_alarmed
    assert not record.is_biased
    assert record.lean is None
    assert record.known_scale == record.block[0]["middle"] == known
