"""Fixes decide which inertial sensor errs, by copies of a filter of before."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.sensor_bank import SensorBank
from executive_plugins.estimation.live.layout import SAMPLE

Z, UP = np.zeros(3), np.array([0.0, 0.0, 9.81])
NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
FIX_STD_M, COUNT, HZ = 0.01, 400, 100
USUAL = 0.8, 1.0
LINEAR_RAD = 0.15


def samples(rate: np.ndarray = Z, force: np.ndarray = Z) -> np.ndarray:
    """Return samples of a body at rest with errors from one second on."""
    ring = np.zeros(COUNT, SAMPLE)
    for k in range(COUNT):
        is_wrong = k >= HZ
        ring[k] = (k + 1) / HZ, 1 / HZ, is_wrong * rate, UP + is_wrong * force
    return ring


def body() -> ErrorStateFilter:
    P = np.diag(np.repeat([1e-6, 1e-4, FIX_STD_M**2 / 10, 1e-8, 1e-6], 3))
    return ErrorStateFilter(
        InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), Z, Z, Z, Z), P, NOISE
    )


def fixes(offset_m: float = 0.0) -> list[tuple[float, Fix, float, float]]:
    """Return ten fixes a second of three seconds, which jump by an offset after one second."""
    rng, answer = np.random.default_rng(7), []
    for k in range(1, 31):
        p = rng.normal(0, FIX_STD_M, 3) + [offset_m * (k > 10), 0.0, 0.0]
        fix = Fix(k / 10, "antenna", np.array([1.0, 0.5, 0.0]), p, FIX_STD_M**2 * np.eye(3))
        answer.append(
            (
                fix.stamp_s,
                Fix(fix.stamp_s, "antenna", fix.arm_imu, p + fix.arm_imu, fix.covariance),
                1.0,
                0.0,
            )
        )
    return answer


def chosen(
    ring: np.ndarray, offset_m: float = 0.0, by_filter: float = -50.0, diverges: str = ""
) -> list[str]:
    """Return what is chosen at each fix from 1.5 s on, the first of them in doubt.

    One hypothesis of a sensor may diverge at first.
    """
    some = fixes(offset_m)
    bank = SensorBank((body().block, 0), some[:15], NOISE.densities, USUAL, 1.55)
    answer = []
    for model in [one for one in bank._models if one.sensor == diverges][:1] * bool(diverges):
        model._block["P"] = np.inf
    for one in some[15:]:
        bank.add_fix(one)
        bank.follow(ring, COUNT, one[0], one[1])
        bank.weigh(by_filter, 3)
        choice = bank.choice(LINEAR_RAD)
        bank.adopted = choice or bank.adopted
        answer.append("" if choice is None else choice.sensor)
    return answer


@pytest.mark.parametrize(
    ("ring", "sensor"),
    [
        (samples(force=np.array([0.5, 0.3, 0.0])), "forces"),
        (samples(rate=np.array([0.0, 0.0, 0.2])), "rates"),
    ],
)
def test_the_sensor_that_errs_is_found_after_three_fixes(ring: np.ndarray, sensor: str) -> None:
    answer = chosen(ring)
    assert answer[:2] == ["", ""]
    assert sensor in answer
    assert set(answer) <= {"", sensor}


def test_sound_sensors_are_not_accused() -> None:
    assert set(chosen(samples())) == {""}


def test_a_hypothesis_that_diverges_does_not_hold_the_other_sensor_up() -> None:
    ring = samples(rate=np.array([0.0, 0.0, 0.2]))
    assert chosen(ring, diverges="forces") == chosen(ring)
    assert "rates" in chosen(ring, diverges="forces")


def test_fixes_that_jump_refute_all_hypotheses() -> None:
    """No step of a sensor moves a body by half a metre within a tenth of a second."""
    some = fixes(0.5)
    bank = SensorBank((body().block, 0), some, NOISE.densities, USUAL, 1.55)
    assert not bank.is_refuted
    bank.follow(samples(), COUNT, 3.0)
    assert bank.is_refuted
    assert set(chosen(samples(), 0.5)) == {""}


def test_a_filter_that_explains_the_fixes_as_well_is_left_alone() -> None:
    ring = samples(force=np.array([0.5, 0.3, 0.0]))
    assert set(chosen(ring, by_filter=50.0)) == {""}


def test_an_attitude_that_is_hardly_known_is_not_adopted() -> None:
    ring = samples(rate=np.array([0.0, 0.0, 0.2]))
    bank = SensorBank((body().block, 0), fixes(), NOISE.densities, USUAL, 1.55)
    bank.follow(ring, COUNT, 1.2)
    bank.weigh(-50.0, 1)
    bank.follow(ring, COUNT, 3.0)
    assert bank.choice(LINEAR_RAD) is not None
    assert bank.choice(1e-4) is None


def test_the_adopted_hypothesis_takes_the_state_of_before_along() -> None:
    """The filter that follows it is at the fixes, with the step in the bias of the force alone."""
    force = np.array([0.5, 0.3, 0.0])
    bank, kalman = SensorBank((body().block, 0), fixes(), NOISE.densities, USUAL, 1.55), body()
    bank.follow(samples(force=force), COUNT, 1.2)
    bank.weigh(-50.0, 1)
    bank.follow(samples(force=force), COUNT, 3.0)
    choice = bank.choice(LINEAR_RAD)
    assert choice is not None
    choice.replace(kalman)
    assert kalman.stamp_s == pytest.approx(3.0)
    assert kalman.state.accel_bias == pytest.approx(force, abs=0.1)
    assert np.abs(kalman.state.gyro_bias).max() < 1e-3
    assert np.linalg.norm(kalman.state.p_map_imu) < 3 * FIX_STD_M
