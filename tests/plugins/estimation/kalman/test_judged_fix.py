"""One compiled call does with a fix what its parts do one by one."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.calm_scale import calm_factor, calm_scale
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm
from executive_plugins.estimation.gate.innovation_bias import InnovationBias
from executive_plugins.estimation.gate.innovation_record import DOUBTED, LEANS, InnovationRecord
from executive_plugins.estimation.gate.innovation_scale import InnovationScale
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import compared, fix_residual
from executive_plugins.estimation.kalman.judged_fix import USED

from executive.arrays import Float
from executive.geometry.rotation import from_rpy

NOISE = InertialNoise(1e-4, 2e-3, 1e-5, 1e-4, 0.03, 9.81, 1e-3)
ARM, GATE, PERIOD_S, FIX_M = np.array([0.4, -1.1, 2.0]), 22.0, 0.05, 0.02
NONE = np.zeros(3)


def moving(clock: ClockOffset) -> ErrorStateFilter:
    A = np.random.default_rng(1).normal(0.0, 0.01, (15, 30))
    sample = Inertial(3.0, np.array([0.2, -0.1, 0.4]), np.array([1.0, 2.0, 9.0]), 0.01)
    v, p = np.array([6.0, 5.0, -1.0]), np.array([4.0, -2.0, 1.0])
    state = InertialState(sample, from_rpy(0.3, -0.2, 1.1), p, v, NONE, NONE)
    return ErrorStateFilter(state, A @ A.T, NOISE, clock)


class Parts:
    """The parts, one by one."""

    def __init__(self, kalman: ErrorStateFilter) -> None:
        self.kalman, self.calm = kalman, calm_scale(10.0)
        self.scale, self.alarm = InnovationScale(3), InnovationAlarm(3)
        self.bias = InnovationBias(3)

    def use(self, fix: Fix) -> int:
        residual, H, by_clock, noise = fix_residual(self.kalman, fix, 0.0)
        predicted = self.kalman.predicted(H, by_clock)
        is_raised, now_s = self.alarm.is_raised, self.kalman.stamp_s
        known = calm_factor(self.calm, now_s, is_raised, self.scale.factor())
        S = predicted + known * noise
        self.alarm.add(residual, S, GATE, PERIOD_S)
        is_near = residual @ np.linalg.solve(S, residual) <= GATE
        if is_near:
            self.bias.add(residual, S, PERIOD_S)
        leans = is_near and self.bias.is_biased
        if not leans:
            self.scale.add(residual, predicted, noise)
            known = self.scale.factor()
        self.noise = known * noise
        if not is_near or self.alarm.is_raised or self.bias.is_biased:
            return DOUBTED | (LEANS if leans else 0)
        return USED * self.kalman.correct(residual, H, self.noise, GATE, by_clock)


def fixes(kind: str) -> list[Float]:
    """Return errors of fixes [m], shape (3,) each."""
    rng = np.random.default_rng(3)
    errors = list(rng.normal(0.0, FIX_M * (3.0 if kind == "noisy" else 1.0), (80, 3)))
    if kind == "jumping":
        errors[20] = np.array([5.0, 0.0, 0.0])
    if kind == "leaning":
        errors = [one + [0.01 * max(0, k - 20), 0.0, 0.0] for k, one in enumerate(errors)]
    return errors


@pytest.mark.parametrize("clock", [ClockOffset(), ClockOffset(0.01, 0.02)], ids=["known", "clock"])
@pytest.mark.parametrize("kind", ["usual", "noisy", "jumping", "leaning"])
def test_the_whole_is_its_parts(kind: str, clock: ClockOffset) -> None:
    kalman, parts = moving(clock), Parts(moving(clock))
    record, said = InnovationRecord(GATE, 10.0, 1.0), set()
    record.expect(PERIOD_S)
    state = kalman.state
    for error in fixes(kind):
        p = state.p_map_imu + state.R_map_imu @ ARM + error
        fix = Fix(3.0, "left", ARM, p, FIX_M**2 * np.eye(3))
        said.add(answer := kalman.use_fix(record.block, fix, 0.0, False))
        assert answer == parts.use(fix)
        if answer & DOUBTED:
            assert compared(kalman)[3] == pytest.approx(parts.noise)
        if answer & LEANS:
            assert record.lean is not None
            assert parts.bias.lean is not None
            assert record.lean.innovation == pytest.approx(parts.bias.lean.innovation)
            assert record.lean.lasts == parts.bias.lean.lasts
            record.clear_bias()
            parts.bias.clear()
        np.testing.assert_allclose(kalman.covariance, parts.kalman.covariance, rtol=1e-9)
        assert kalman.state.p_map_imu == pytest.approx(parts.kalman.state.p_map_imu, abs=1e-9)
        assert kalman.clock_s == pytest.approx(parts.kalman.clock_s, abs=1e-12)
    assert USED in said
    assert (DOUBTED in said) == (kind != "usual")
    assert (DOUBTED | LEANS in said) == (kind == "leaning")


def test_a_clock_that_is_held_stays() -> None:
    kalman, record = moving(ClockOffset(0.01, 0.02)), InnovationRecord(GATE, 10.0, 1.0)
    record.expect(PERIOD_S)
    p = kalman.state.p_map_imu + kalman.state.R_map_imu @ ARM + 0.02
    fix = Fix(3.0, "left", ARM, p, FIX_M**2 * np.eye(3))
    assert kalman.use_fix(record.block, fix, 0.01, True) == USED
    assert (kalman.clock_s, kalman.holds_clock) == (0.01, True)
    assert kalman.use_fix(record.block, fix, 0.01, False) == USED
    assert kalman.clock_s != 0.01
