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


def exact(t, off=(0.0, 0.0, 0.0), *, odometry=True, std_m=0.01, speed=VELOCITY):
    """Compare a fix that is off by so much, without noise, with a right odometry."""
    truth = t * np.asarray(speed)
    fix = Fix(t, "gnss_left", np.zeros(3), truth + off, std_m**2 * np.eye(3))
    p_odometry = R_MAP_ODOMETRY.T @ truth
    residual = np.asarray(off, dtype=float)
    return Compared(fix, residual, 2 * std_m**2 * np.eye(3), p_odometry, R_MAP_ODOMETRY, odometry)


def test_the_distance_is_mahalanobis_squared() -> None:
    covariance = np.diag([0.01, 0.04, 0.25])
    off = np.array([0.2, 0.4, 1.0])
    compared = Compared(exact(0.0).fix, off, covariance, np.zeros(3), np.eye(3), True)
    assert compared.distance2 == pytest.approx(4.0 + 4.0 + 4.0)


def test_a_fix_that_moves_with_the_odometry_has_not_moved() -> None:
    off = np.array([0.1, 0.2, -0.3])
    assert exact(3.0).moved_since(exact(1.0)) == pytest.approx(np.zeros(3), abs=1e-12)
    assert exact(3.0, off).moved_since(exact(1.0)) == pytest.approx(off)


@pytest.mark.parametrize(("count", "spacing_s"), [(5, 0.4), (12, 0.1)])
def test_few_fixes_or_a_short_time_tell_no_drift(count: int, spacing_s: float) -> None:
    gate = GnssGate(GnssGateSettings(innovation=1e9))
    offs = np.linspace(0.0, 5.0, count)
    assert not any(
        gate.refusal(exact(spacing_s * k, (off, 0, 0), speed=np.zeros(3)))
        for k, off in enumerate(offs)
    )


def test_a_step_between_the_first_and_last_third_is_told_with_its_size() -> None:
    # 0.1 m is usual, and noise explains three standard deviations of two means of three fixes.
    explained_m = 0.1 + 3 * np.sqrt(2 * 3 * 0.01**2 / 3)
    for step_m, word in ((1.01 * explained_m, "drifted by 0.14 m"), (0.99 * explained_m, "")):
        gate = GnssGate(GnssGateSettings(innovation=1e9))
        told = [
            gate.refusal(exact(0.2 * k, (step_m if k > 4 else 0.0, 0, 0), speed=np.zeros(3)))
            for k in range(9)
        ]
        assert not any(told[:8])
        assert told[8].startswith(word)
        assert bool(told[8]) == bool(word)


def test_a_fix_leaves_the_window_after_its_time() -> None:
    gate = GnssGate(GnssGateSettings(innovation=1e9))
    still = {"speed": np.zeros(3)}
    for k in range(3):
        gate.refusal(exact(0.1 * k, (3.0, 0, 0), **still))
    later = [gate.refusal(exact(3.3 + 0.1 * k, **still)) for k in range(30)]
    assert set(later) == {""}


def test_when_the_odometry_starts_again_the_fixes_before_are_forgotten() -> None:
    gate = GnssGate(GnssGateSettings(innovation=1e9))
    still = {"speed": np.zeros(3)}
    for k in range(10):
        gate.refusal(exact(0.2 * k, (3.0, 0, 0), **still))
    gate.forget_odometry()
    assert not any(gate.refusal(exact(2.0 + 0.2 * k, **still)) for k in range(10))


def recovered(gate: GnssGate, count: int, off_m: float = 0.0, begin_s: float = 0.0) -> list[bool]:
    return [gate.is_in_line(exact(begin_s + 0.2 * k, (off_m, 0, 0))) for k in range(count)]


@pytest.mark.parametrize(("count", "word"), [(4, ""), (5, "5 fixes in a row agree, 0.02 m off")])
def test_five_fixes_over_most_of_a_second_are_trusted_again(count: int, word: str) -> None:
    gate = GnssGate(GnssGateSettings())
    assert all(recovered(gate, count, 0.02))
    assert gate.verdict(0.0, 0.0) == word


@pytest.mark.parametrize(("way_m", "lost_s", "is_near"), [(0, 0, 0), (100, 0, 1), (0, -100, 1)])
def test_a_long_way_or_time_without_fixes_explains_more(way_m, lost_s, is_near) -> None:
    # Three standard deviations of 1.4 cm, and 1 % of the way, and 1 cm each second.
    gate = GnssGate(GnssGateSettings())
    recovered(gate, 5, 0.9)
    assert bool(gate.verdict(way_m, lost_s)) == bool(is_near)
    assert not gate.verdict(0.8 * way_m, 0.8 * lost_s)


def test_without_odometry_the_drift_grows_with_the_square_of_time() -> None:
    gate = GnssGate(GnssGateSettings())
    for k in range(5):
        gate.is_in_line(exact(0.2 * k, (20.0, 0, 0), odometry=False))
    assert not gate.verdict(0.0, 0.8 - 8.0)
    assert gate.verdict(0.0, 0.8 - 9.0)


def test_a_jump_begins_the_sequence_anew_and_so_does_a_pause() -> None:
    gate = GnssGate(GnssGateSettings())
    assert all(recovered(gate, 5))
    assert recovered(gate, 5, 0.31, begin_s=1.0) == [False, True, True, True, True]
    assert gate.verdict(100.0, 0.0).startswith("5 fixes")
    assert gate.is_in_line(exact(1.8 + 0.79, (0.31, 0, 0)))
    assert not gate.is_in_line(exact(1.8 + 0.79 + 0.81, (0.31, 0, 0)))
    assert len(gate.agreed(0.0)) == 1


def test_fixes_that_agree_long_or_are_refused_long_set_the_position() -> None:
    gate = GnssGate(GnssGateSettings())
    recovered(gate, 51, 5.0)
    assert not gate.verdict(0.0, 0.0)  # for ten seconds
    gate.is_in_line(exact(10.2, (5.0, 0, 0)))
    assert gate.verdict(0.0, 0.0) == "fixes agree for 10 s, 5.00 m off: position reset to them"
    for k in range(301):  # each one disagrees with the one before
        gate.is_in_line(exact(10.2 + 0.2 * k, (5.0 + k % 2, 0, 0)))
    assert gate.verdict(0.0, 0.0).startswith("fixes refused for 60 s, ")
    gate.begin_recovery()
    gate.is_in_line(exact(80.0, (5.0, 0, 0)))
    assert gate.verdict(0.0, 80.0) == ""


def test_the_newest_agreeing_fixes_are_handed_over() -> None:
    gate = GnssGate(GnssGateSettings())
    recovered(gate, 20)
    assert [c.fix.stamp_s for c in gate.agreed(0.0)] == pytest.approx([3.0, 3.2, 3.4, 3.6, 3.8])
    assert [c.fix.stamp_s for c in gate.agreed(3.5)] == pytest.approx([3.6, 3.8])


@pytest.mark.parametrize("has_odometry", [False, True])
def test_fixes_that_drift_against_the_odometry_do_not_recover(has_odometry: bool) -> None:
    """Neighbours agree within the jump, and at 2 m/s they are 1.6 m apart in 0.8 s."""
    gate = GnssGate(GnssGateSettings())
    gate.begin_recovery()
    settings = GnssGateSettings()
    stamps_s = np.arange(0.0, 2.0, 0.05)
    in_line = [
        gate.is_in_line(exact(t, (2.0 * t, 0, 0), odometry=has_odometry, speed=np.zeros(3)))
        for t in stamps_s
    ]
    assert all(in_line) is not has_odometry
    refused_s = stamps_s[np.flatnonzero(np.logical_not(in_line))]
    if has_odometry:
        assert refused_s[0] == pytest.approx(0.9 * settings.recover_after_s, abs=0.051)
        # The count begins anew with the fix that was refused.
        assert refused_s[1] - refused_s[0] == pytest.approx(refused_s[0], abs=0.051)
