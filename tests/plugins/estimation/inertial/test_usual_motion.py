"""What a body may do in a gap follows from what it has done; a machine at rest may still move."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.usual_motion import UsualMotion, add_motion


def _after(acceleration_m_s2: float, rate_rad_s: float) -> UsualMotion:
    usual = UsualMotion(memory := np.empty(3))
    for stamp_s in np.arange(0.0, 120.0, 0.1):
        wave = np.sin(0.7 * stamp_s) * np.sqrt(2)
        acceleration, rate = np.full(3, acceleration_m_s2 * wave), np.full(3, rate_rad_s * wave)
        add_motion(memory, stamp_s, acceleration, rate)
    return usual


def test_a_lively_body_goes_on_as_it_did() -> None:
    usual = _after(4.0, 2.0)
    assert usual.acceleration_m_s2 == pytest.approx(4.0, rel=0.15)
    assert usual.rate_rad_s == pytest.approx(2.0, rel=0.15)


def test_a_body_at_rest_may_begin_to_move() -> None:
    usual = _after(0.0, 0.0)
    assert usual.acceleration_m_s2 == pytest.approx(1.0)
    assert usual.rate_rad_s == pytest.approx(0.8)


def test_samples_count_ten_times_a_second() -> None:
    usual, lively = UsualMotion(memory := np.empty(3)), np.full(3, 1e3)
    add_motion(memory, 1.0, lively, lively)  # the first only tells the time
    add_motion(memory, 1.05, lively, lively)
    assert usual.step == (0.8, 1.0)
    add_motion(memory, 1.11, lively, lively)
    assert usual.acceleration_m_s2 > 10.0
    assert usual.rate_rad_s > 10.0
