"""The gate of fixes over random fixes on a coarse grid, where limits are often met exactly."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.gnss_gate import Compared, GnssGate
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.settings import GnssGateSettings

TURNED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
LIMITS = {
    "innovation": 4.0,
    "window_s": 2.0,
    "window_drift_m": 0.5,
    "recover_after": 4,
    "recover_after_s": 1.0,
    "recover_drift_m": 0.25,
    "jump_m": 0.5,
    "odometry_drift": 0.25,
    "odometry_drift_m_s": 0.125,
    "inertial_drift_m_s2": 0.25,
    "reanchor_after_s": 3.0,
    "unlock_after_s": 5.0,
}


def fixes(seed: int, noise_m2: float, count: int = 300) -> list[Compared]:
    rng = np.random.default_rng(seed)
    stamp_s, offset, reckoned, made = 0.0, np.zeros(3), np.zeros(3), []
    for _ in range(count):
        stamp_s += float(rng.choice([0.25, 0.25, 0.25, 0.5, 1.0, 1.25]))
        offset = offset + rng.choice([0.0, 0.0, 0.125, 0.25, 0.5], 3) * [1, 0, 0]
        reckoned = reckoned + rng.choice([0.0, 0.5], 3)
        position = TURNED @ reckoned + offset
        residual = rng.choice([0.0, 0.5, 1.0, 2.0], 3) * [1, 0, rng.integers(2)]
        fix = Fix(stamp_s, "left", np.zeros(3), position, noise_m2 * np.eye(3))
        has_odometry, slack_m = bool(rng.random() < 0.8), float(rng.choice([0.0, 0.25]))
        made.append(
            Compared(fix, residual, np.diag([1.0, 1, 4]), reckoned, TURNED, has_odometry, slack_m)
        )
    return made


@pytest.mark.parametrize("noise_m2", [0.0, 0.001])
@pytest.mark.parametrize("seed", [1, 2])
def test_refusals(recorded, seed, noise_m2) -> None:
    gate = GnssGate(GnssGateSettings(**LIMITS))
    told = []
    for k, one in enumerate(fixes(seed, noise_m2)):
        if k % 40 == 39:
            gate.forget_odometry()
        told.append((k, one.distance2, gate.refusal(one)))
    recorded(told)


@pytest.mark.parametrize("noise_m2", [0.0, 0.001])
@pytest.mark.parametrize("seed", [3, 4])
def test_recovery(recorded, seed, noise_m2) -> None:
    gate = GnssGate(GnssGateSettings(**LIMITS))
    told: list[object] = []
    for k, one in enumerate(fixes(seed, noise_m2)):
        if k % 60 == 59:
            gate.begin_recovery()
        in_line = gate.is_in_line(one)
        way_m, lost_s = 0.5 * (k % 5), one.fix.stamp_s - 0.5 * (k % 8)
        agreed = [c.fix.stamp_s for c in gate.agreed(one.fix.stamp_s - 0.25 * (k % 6))]
        told.append((k, in_line, gate.verdict(way_m, lost_s), agreed))
    recorded(told)


@pytest.mark.parametrize("has_odometry", [True, False])
def test_steady_fixes_reach_each_verdict(recorded, has_odometry) -> None:
    """At rest, off by more and more: used at once, after a while, or after a long time."""
    told = []
    for off_m in (0.0, 3.0, 3.125, 4.0, 9.0):
        gate = GnssGate(GnssGateSettings(**LIMITS))
        for k in range(30):
            fix = Fix(0.25 * k, "left", np.zeros(3), np.zeros(3), np.zeros((3, 3)))
            residual = np.array([off_m, 0, 0])
            one = Compared(fix, residual, np.eye(3), np.zeros(3), np.eye(3), has_odometry)
            told.append((off_m, k, gate.is_in_line(one), gate.verdict(0.5, 0.0)))
    recorded(told)


def test_jumping_fixes_are_used_in_the_end(recorded) -> None:
    gate, told = GnssGate(GnssGateSettings(**LIMITS)), []
    for k in range(30):
        position = np.array([2.0 * (k % 2), 0, 0])
        fix = Fix(0.25 * k, "left", np.zeros(3), position, np.zeros((3, 3)))
        one = Compared(fix, np.array([9.0, 0, 0]), np.eye(3), np.zeros(3), np.eye(3), True)
        told.append((k, gate.is_in_line(one), gate.verdict(0.0, 0.0)))
    recorded(told)
