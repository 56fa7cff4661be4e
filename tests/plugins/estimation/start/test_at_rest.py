"""The first state at rest: level by both accelerometers, correlations, and noisy fixes."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    GYRO_BIAS,
    ROTATION,
    VELOCITY,
    Inertial,
)
from executive_plugins.estimation.start.at_rest import RestInitialisation
from executive_plugins.estimation.start.first_state import FirstState
from executive_plugins.estimation.start.settings import RestSettings, WindowStartSettings

from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.rotation import log_so3
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample

NOISE = InertialNoise(4e-4, 4e-3, 2e-5, 3e-4, 0.03, 9.81, 0.01)
ARMS = {"left": np.array([-1.0, 1.0, 1.2]), "right": np.array([-1.0, -1.0, 1.2])}


def at_rest(force: np.ndarray, std_m: float = 0.01):
    """A cabin that rests for three seconds, its axes those of the map."""
    rng = np.random.default_rng(3)
    rest = RestInitialisation(RestSettings(), ARMS, NOISE)
    for k in range(300):
        rest.add_sample(
            Inertial(k / 100, rng.normal(0, 1e-4, 3), force + rng.normal(0, 0.02, 3), 0.01)
        )
        for name, arm in ARMS.items() if k % 5 == 0 else ():
            rest.add_fix(k / 100, name, arm + rng.normal(0, std_m, 3), std_m)
    return rest


def test_tilt_and_bias_are_one_error_until_the_machine_moves() -> None:
    state, P = at_rest(np.array([0.1, -0.05, 9.81])).state()
    F = np.zeros(
        (3, 15)
    )  # of the acceleration seen in the map, by central differences: it stays known at rest
    for i, block in [*((i, ROTATION) for i in range(3)), *((i, ACCEL_BIAS) for i in range(3))]:
        step = np.zeros(3)
        step[i] = 1e-6
        turned = [state.R_map_imu @ _exp(sign * step * (block == ROTATION)) for sign in (1, -1)]
        bias = [state.accel_bias + sign * step * (block == ACCEL_BIAS) for sign in (1, -1)]
        seen = [R @ (state.sample.force - b) for R, b in zip(turned, bias, strict=True)]
        F[:, block.start + i] = (seen[0] - seen[1]) / 2e-6
    std = np.sqrt(np.diag(F @ P @ F.T))
    assert std[:2].max() < 0.005  # of the mean force [m/s²]; taken as independent it would be 0.042
    assert np.sqrt(np.diag(P)[ROTATION]).max() == pytest.approx(0.03 / 9.81, rel=0.1)
    assert np.linalg.eigvalsh(P).min() > -1e-12


def _exp(v: np.ndarray) -> np.ndarray:
    return np.eye(3) + np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def test_the_chassis_accelerometer_halves_the_variance_of_the_tilt(cabin, begin) -> None:
    """The cabin's is off by b across gravity, the chassis' by −b: together they are level."""
    biased = {"imu_cabin": np.array([0.03, 0.02, 0.0]), "imu_base": -np.array([0.03, 0.02, 0.0])}

    def first(names):
        estimator = begin(rest={"duration_s": 2.0})
        for observation in replace(cabin, accel_bias=np.zeros(3)).observations(3.0):
            if isinstance(observation, ImuSample):
                if observation.frame not in names:
                    continue
                force = observation.specific_force_m_s2 + biased[observation.frame]
                observation = replace(observation, specific_force_m_s2=force)
            estimator.add(observation)
            if (state := estimator.state()).is_ready:
                return state
        raise AssertionError("it never began")

    alone, together = first({"imu_cabin"}), first({"imu_cabin", "imu_base"})
    off = [
        np.linalg.norm(log_so3(s.T_map_cabin[:3, :3] @ cabin.T_map_cabin(0.0)[:3, :3].T)[:2])
        for s in (alone, together)
    ]
    assert off[0] > 0.003
    assert off[1] < 0.001
    assert together.covariance[0, 0] == pytest.approx(alone.covariance[0, 0] / 2, rel=0.1)


def test_a_chassis_sensor_that_disagrees_by_too_much_is_not_used(cabin, begin) -> None:
    estimator = begin()
    for observation in cabin.observations(3.0):
        if isinstance(observation, ImuSample) and observation.frame == "imu_base":
            observation = replace(
                observation, specific_force_m_s2=np.roll(observation.specific_force_m_s2, 1)
            )
        estimator.add(observation)
    off = log_so3(estimator.state().T_map_cabin[:3, :3] @ cabin.T_map_cabin(0.0)[:3, :3].T)
    assert np.linalg.norm(off) < 0.01


def test_noisy_fixes_are_no_motion_if_their_covariance_is_large(
    cabin, begin, errors_m, run
) -> None:
    def noisier(observation, rng):
        if not isinstance(observation, GnssFix):
            return observation
        std = 4 * np.sqrt(np.diag(observation.covariance_enu_m2))
        error = geodetic_from_enu(rng.normal(0, std), observation.geodetic)
        return replace(
            observation, geodetic=error, covariance_enu_m2=25 * observation.covariance_enu_m2
        )

    rng = np.random.default_rng(5)
    estimator = begin()
    states = run(estimator, [noisier(o, rng) for o in cabin.observations(14.0)])
    assert states[-1].status == "GLOBAL"
    assert next(s.stamp_s for s in states if s.is_ready) < 3.0
    assert errors_m(cabin, states).max() < 0.15  # 4 cm across and 7.5 cm up, each fix


def test_less_certain_fixes_leave_the_first_state_less_certain() -> None:
    good, poor = (
        np.sqrt(np.diag(at_rest(np.array([0, 0, 9.81]), std).state()[1])) for std in (0.01, 0.05)
    )
    assert poor[VELOCITY].min() > 2 * good[VELOCITY].max()
    assert poor[ROTATION].max() > 3 * good[ROTATION].max()  # the heading's
    np.testing.assert_allclose(poor[GYRO_BIAS], good[GYRO_BIAS], rtol=1e-6)


def test_the_reason_for_waiting_is_reported_every_few_seconds(cabin, begin) -> None:
    estimator = begin()
    for observation in cabin.observations(5.5):
        if getattr(observation, "antenna", "") != "gnss_right":
            estimator.add(observation)
    assert estimator.state().status == "INITIALISING"
    account = estimator.account()
    assert 1 <= len(account) <= 2  # once in five seconds
    for told in account:
        assert "fixes of gnss_right: fewer than five" in told.reason
        assert told.after == "INITIALISING"


def test_a_machine_that_drives_evenly_is_not_taken_as_standing(cabin, begin) -> None:
    estimator = begin()
    for observation in cabin.observations(4.0):
        if isinstance(observation, GnssFix):
            moved = geodetic_from_enu(
                np.array([0.3 * observation.stamp_s, 0, 0]), observation.geodetic
            )
            observation = replace(observation, geodetic=moved)
        estimator.add(observation)
    state = estimator.state()
    assert state.is_ready
    assert state.v_map_cabin == pytest.approx([0.3, 0.0, 0.0], abs=0.1)


def test_coarse_fixes_of_two_antennas_at_rest_give_no_heading() -> None:
    def headings(std_m: float) -> list[bool]:
        rng = np.random.default_rng(3)
        first = FirstState(RestSettings(), WindowStartSettings(), ARMS, NOISE, None)
        found = []
        for k in range(300):
            for name, arm in ARMS.items() if k % 20 == 0 else ():
                fix = arm + rng.normal(0, std_m, 3)
                first.add_fix(k / 100, name, fix, std_m**2 * np.eye(3))
            force = np.array([0.0, 0.0, 9.81]) + rng.normal(0, 0.02, 3)
            one = first.add_sample(Inertial(k / 100, rng.normal(0, 1e-4, 3), force, 0.01), 0.0)
            found += [] if one is None else [one.has_heading]
            if any(found):
                break
        return found

    assert headings(0.01)[-1]
    assert not any(headings(0.7))
