"""The gate for fixes, with an odometry that moves at constant velocity."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.gnss_gate import Compared, GnssGate
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.settings import GnssGateSettings

from executive.geometry.rotation import from_rpy

R_MAP_ODOMETRY = from_rpy(0.0, 0.0, 1.2)
VELOCITY = np.array([0.8, -0.2, 0.0])


def compare(t, error, rng, estimate_error=0.0, has_odometry=True):
    """Compare a fix that is wrong by `error` with a right estimate and a right odometry in a frame
    of its own.
    """
    truth = t * VELOCITY
    measured = truth + error + rng.normal(0, 0.01, 3)
    fix = Fix(t, "gnss_left", np.zeros(3), measured, 1e-4 * np.eye(3))
    residual, p_odometry = measured - truth - estimate_error, R_MAP_ODOMETRY.T @ truth
    return Compared(fix, residual, 2e-4 * np.eye(3), p_odometry, R_MAP_ODOMETRY, has_odometry)


@pytest.fixture
def gate() -> GnssGate:
    return GnssGate(GnssGateSettings())


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(4)


def test_clean_fixes_pass_for_minutes(gate, rng) -> None:
    refused = [gate.refusal(compare(k / 20, np.zeros(3), rng)) for k in range(3000)]
    assert set(refused) == {""}


def test_a_jump_is_refused_by_its_innovation(gate, rng) -> None:
    reason = gate.refusal(compare(0.0, np.array([3.0, 0, 0]), rng))
    assert reason.endswith("m off the estimate")


def first_refused_s(rng, drift_m_s, clean_s, has_odometry=True) -> float:
    """Return when fixes are refused that drift after clean seconds; counted from their drift."""
    gate = GnssGate(GnssGateSettings())
    for k in range(round(20 * clean_s) + 200):
        ramp = np.array([drift_m_s * max(k / 20 - clean_s, 0.0), 0, 0])
        if gate.refusal(compare(k / 20, ramp, rng, estimate_error=ramp, has_odometry=has_odometry)):
            return k / 20 - clean_s
    return np.inf


def test_a_ramp_that_the_estimate_follows_is_detected_by_the_odometry(rng) -> None:
    assert 1.0 < first_refused_s(rng, 0.1, 12.0) < 2.5
    assert first_refused_s(rng, 0.1, 12.0, has_odometry=False) == np.inf


def test_odometry_that_has_always_drifted_refutes_no_fix(rng) -> None:
    assert first_refused_s(rng, 0.03, 0.0) == np.inf  # 4 % of the way from the first metre on


def recovered_s(gate, rng, error, until_s=100.0, lost_s=0.0):
    """Return when the gate believes fixes with an error by time, and why."""
    gate.begin_recovery()
    for k in range(round(20 * until_s)):
        compared = compare(k / 20, error(k / 20), rng)
        reason = gate.verdict(0.0, lost_s) if gate.is_in_line(compared) else ""
        if reason:
            return k / 20, reason
    return np.inf, ""


def test_good_fixes_are_used_again_after_a_second(gate, rng) -> None:
    back_s, reason = recovered_s(gate, rng, lambda t: np.zeros(3))
    assert 0.75 < back_s < 1.0
    assert "in a row agree" in reason


def test_constant_wrong_fixes_are_not_used_for_ten_seconds(gate, rng) -> None:
    back_s, reason = recovered_s(gate, rng, lambda t: np.array([5.0, 0, 0]))
    assert 10.0 < back_s < 10.5
    assert "position reset" in reason


def test_fixes_that_never_agree_are_used_after_a_minute(gate, rng) -> None:
    back_s, reason = recovered_s(gate, rng, lambda t: np.array([2.0 * round(20 * t), 0, 0]))
    assert back_s == np.inf  # each fix disagrees with the one before: there is nothing to believe
    gate = GnssGate(GnssGateSettings())
    back_s, reason = recovered_s(gate, rng, lambda t: np.array([2.0 * (round(10 * t) // 5), 0, 0]))
    assert 60.0 < back_s < 61.0
    assert "refused for 60 s" in reason


def test_drift_of_the_odometry_over_a_long_outage_is_allowed_for(gate, rng) -> None:
    gate.begin_recovery()
    for k in range(18):
        gate.is_in_line(compare(100 + k / 20, np.array([0.5, 0, 0]), rng))
    assert gate.verdict(way_m=10.0, lost_s=99.0) == ""
    assert "0.5" in gate.verdict(way_m=60.0, lost_s=99.0)


def test_agreeing_fixes_are_at_most_as_old_as_recovery_takes(gate, rng) -> None:
    recovered_s(gate, rng, lambda t: np.array([5.0, 0, 0]))
    stamps = [compared.fix.stamp_s for compared in gate.agreed(after_s=0.0)]
    assert len(stamps) >= 15
    assert stamps[-1] - stamps[0] < 0.85
