"""A bank of filters keeps the headings that explain all fixes, and drops the others."""

import numpy as np
import pytest
from executive_plugins.estimation.cabin.aligning_witness import AligningWitness
from executive_plugins.estimation.cabin.heading_bank import HeadingBank
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    Inertial,
    InertialState,
    propagate,
)
from executive_plugins.estimation.live.layout import SAMPLE
from executive_plugins.estimation.start.found import Found
from scipy.stats import chi2

from executive.arrays import Float
from executive.geometry.rotation import from_rpy, log_so3, skew, yaw_of

Z = np.zeros(3)
UP = np.array([0.0, 0.0, 9.81])
NOISE = InertialNoise(1e-3, 1e-2, 1e-6, 1e-5, 1e-2, 9.81, 1e-3)
ARM_M = np.array([1.0, 0.5, 2.0])
FIX_M = 0.02


def unknown_heading(std_rad: float = np.pi / np.sqrt(3)) -> Found:
    """A body at rest that faces east by the first guess, and whose antenna is known."""
    state = InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), -ARM_M, Z, Z, Z)
    P = np.diag(np.repeat([0.005, 0.02, FIX_M, 1e-4, 1e-3], 3) ** 2)
    P[2, 2] = std_rad**2
    around = np.eye(DIMENSION)
    around[POSITION, ROTATION] = skew(ARM_M)
    return Found(state, around @ P @ around.T, False, ClockOffset())


def driven(heading_rad: float, accelerates: bool, seed: int = 0) -> tuple[HeadingBank, Float]:
    """Return the bank after three seconds, and the error of its state with pose first, (6,)."""
    rng, bank = (
        np.random.default_rng(seed),
        HeadingBank(unknown_heading(), NOISE, AligningWitness()),
    )
    R = from_rpy(0.0, 0.0, heading_rad)
    true, ring = (
        InertialState(Inertial(0.0, Z, UP, 0.01), R, -R @ ARM_M, Z, Z, Z),
        np.zeros(1, SAMPLE),
    )
    for i in range(1, 301):
        at_s = i / 100
        force = UP + [1.5 * accelerates * np.sin(2 * at_s), 0.0, 0.0]
        true = propagate(true, Inertial(at_s, Z, force, 0.01), 9.81)
        shaken = rng.normal(0.0, 1e-2 * np.sqrt(100), 3)
        turned = rng.normal(0.0, 1e-3 * np.sqrt(100), 3)
        ring[0] = at_s, 0.01, turned, force + shaken
        assert bank.predict_until(ring, 0, 1, at_s) == 1
        if i % 10 == 0:
            p = true.p_map_imu + true.R_map_imu @ ARM_M + rng.normal(0.0, FIX_M, 3)
            assert bank.correct(Fix(at_s, "left", ARM_M, p, FIX_M**2 * np.eye(3)), 0.0, 1.0, 60.0)
    found = bank.state
    turn = log_so3(found.R_map_imu.T @ true.R_map_imu)
    return bank, np.concatenate([turn, true.p_map_imu - found.p_map_imu])


POSE = np.r_[ROTATION, POSITION]


@pytest.mark.parametrize("heading_rad", [0.3, -1.2, 2.9])
def test_an_acceleration_tells_the_heading(heading_rad: float) -> None:
    bank, error = driven(heading_rad, accelerates=True)
    assert yaw_of(bank.state.R_map_imu) == pytest.approx(heading_rad, abs=0.1)
    P = bank.reported()[1][np.ix_(POSE, POSE)]
    assert P[2, 2] < 0.1**2
    assert error @ np.linalg.solve(P, error) < chi2.ppf(0.999, 6)


@pytest.mark.parametrize("seed", range(3))
def test_a_body_at_rest_keeps_all_headings_within_its_covariance(seed: int) -> None:
    bank, error = driven(2.9, accelerates=False, seed=seed)
    P = bank.reported()[1][np.ix_(POSE, POSE)]
    assert P[2, 2] > 0.5**2  # the noise of its acceleration tells little
    assert error @ np.linalg.solve(P, error) < chi2.ppf(0.999, 6)


def test_the_mean_of_all_headings_is_reported_with_its_covariance() -> None:
    bank = HeadingBank(unknown_heading(), NOISE, AligningWitness())
    for at_s in (0.1, 0.2, 0.3):
        bank.correct(Fix(at_s, "left", ARM_M, Z, FIX_M**2 * np.eye(3)), 0.0, 1.0, 60.0)
    mean, P = bank.reported()
    # All headings being alike, the sensor is anywhere on a circle about its antenna.
    assert np.linalg.norm(mean.p_map_imu[:2]) < 0.3
    assert mean.p_map_imu[2] == pytest.approx(-ARM_M[2], abs=0.05)
    radius2 = float(ARM_M[:2] @ ARM_M[:2])
    assert P[6, 6] + P[7, 7] == pytest.approx(radius2, rel=0.1)
    assert np.linalg.norm(bank.state.p_map_imu[:2]) > 1.0  # the likeliest is on it


def test_a_heading_that_is_nearly_known_takes_one_filter() -> None:
    found = unknown_heading(0.2)
    bank = HeadingBank(found, NOISE, AligningWitness())
    assert bank.state is found.state
    assert bank.reported()[1][2, 2] == pytest.approx(0.2**2)


@pytest.mark.parametrize("off_m", [100.0, np.nan])
def test_a_fix_that_no_filter_explains_changes_nothing(off_m: float) -> None:
    bank = HeadingBank(unknown_heading(), NOISE, AligningWitness())
    before = bank.state
    fix = Fix(0.0, "left", ARM_M, np.full(3, off_m), FIX_M**2 * np.eye(3))
    assert not bank.correct(fix, 0.0, 1.0, 60.0)
    assert bank.state is before


def test_the_covariance_holds_a_fix_that_has_moved_the_state_unlikely_far() -> None:
    """The bank of the next state begins with what the fixes said of this one."""
    witness = AligningWitness()
    bank = HeadingBank(unknown_heading(), NOISE, witness)
    for at_s, off_m in ((0.0, 0.0), (1.0, 0.0), (2.0, 0.15)):
        fix = Fix(at_s, "left", ARM_M, np.array([0.0, 0.0, off_m]), FIX_M**2 * np.eye(3))
        assert bank.correct(fix, 0.0, 1.0, 60.0)
    up = POSITION.start + 2
    assert bank.reported()[1][up, up] > 0.1**2
    for known, is_held in ((witness, True), (AligningWitness(), False)):
        P = HeadingBank(unknown_heading(), NOISE, known).reported()[1]
        assert (P[up, up] > 0.1**2) == is_held
