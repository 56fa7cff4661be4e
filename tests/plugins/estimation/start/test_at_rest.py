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
    assert not any(headings(1.0))


def rested(samples: int, fixes: int, duration_s: float = 2.0) -> RestInitialisation:
    """A cabin at rest, its samples and fixes spread evenly over a time that ends at 100 s."""
    rest = RestInitialisation(RestSettings(), ARMS, NOISE)
    for stamp_s in np.linspace(100.0 - duration_s, 100.0, samples):
        rest.add_sample(Inertial(stamp_s, np.zeros(3), np.array([0.0, 0.0, 9.81]), 0.01))
    for stamp_s in np.linspace(100.0 - duration_s, 100.0, fixes):
        for name, arm in ARMS.items():
            rest.add_fix(stamp_s, name, arm, 0.01)
    return rest


def test_twenty_samples_and_five_fixes_are_enough_and_fewer_are_not() -> None:
    assert rested(20, 5).state() is not None
    too_few = rested(19, 5)
    assert too_few.state() is None
    assert (too_few.waits_for, too_few.moves) == ("", False)
    too_few = rested(20, 4)
    assert too_few.state() is None
    assert too_few.waits_for == "fixes of left and right: fewer than five so far"
    assert not too_few.moves


def test_nine_tenths_of_the_time_are_enough_and_less_is_not() -> None:
    assert rested(100, 10, 1.81).state() is not None
    assert rested(100, 10, 1.79).state() is None
    assert rested(400, 10, 4.0).state() is not None  # the oldest are forgotten
    assert RestInitialisation(RestSettings(), ARMS, NOISE).state() is None


@pytest.mark.parametrize(
    ("rate", "force", "moved_m", "word"),
    [
        (lambda k: 0.03, lambda k: 0.0, 0.0, "rest: it turns at 0.030 rad/s"),
        (lambda k: 0.03 * (-1) ** k, lambda k: 0.0, 0.0, "rest: its rate varies by 0.030 rad/s"),
        (lambda k: 0.0, lambda k: 0.4 * (-1) ** k, 0.0, "rest: its force varies by 0.40 m/s²"),
        (lambda k: 0.0, lambda k: 0.0, 0.07, "rest: the fixes of left vary by 0.070 m"),
        (lambda k: 0.01, lambda k: 0.2 * (-1) ** k, 0.05, ""),
    ],
)
def test_the_sign_of_motion_is_told(rate, force, moved_m, word) -> None:
    rest = RestInitialisation(RestSettings(), ARMS, NOISE)
    for k in range(200):
        f = np.array([0.0, 0.0, 9.81 + force(k)])
        rest.add_sample(Inertial(k / 100, np.array([0.0, 0.0, rate(k)]), f, 0.01))
        for name, arm in ARMS.items() if k % 10 == 0 else ():
            sign = (-1) ** (k // 10) if name == "left" else 0
            rest.add_fix(k / 100, name, arm + np.array([sign * moved_m, 0, 0]), 0.01)
    state = rest.state()
    assert rest.waits_for == word
    assert rest.moves == bool(word) == (state is None)


def test_unrest_is_the_change_from_the_first_half_to_the_second() -> None:
    def unrest(turn_rad_s: float, tilt_rad: float) -> float:
        rest = RestInitialisation(RestSettings(), ARMS, NOISE)
        for k in range(200):
            late = k >= 100
            f = 9.81 * np.array([0.0, np.sin(late * tilt_rad), np.cos(late * tilt_rad)])
            rest.add_sample(Inertial(k / 100, np.array([0, late * turn_rad_s, 0.0]), f, 0.01))
        return rest.unrest_rad_s()

    assert unrest(0.0, 0.0) == 0.0
    assert unrest(-0.004, 0.001) == pytest.approx(0.004)
    assert unrest(0.001, 0.01) == pytest.approx(0.01 / 0.99, rel=1e-3)


def test_one_antenna_gives_a_level_attitude_of_any_heading() -> None:
    rest = RestInitialisation(RestSettings(), {"left": ARMS["left"]}, NOISE)
    force = 9.81 * np.array([0.1, -0.2, np.sqrt(0.95)])
    for k in range(300):
        rest.add_sample(Inertial(k / 100, np.array([1e-3, 2e-3, 3e-3]), force, 0.01))
        if k % 10 == 0:
            rest.add_fix(k / 100, "left", np.array([5.0, 6.0, 7.0]), 0.01)
    state, P = rest.state()
    assert state.stamp_s == 2.99
    assert state.R_map_imu @ force == pytest.approx([0.0, 0.0, 9.81])
    assert np.linalg.det(state.R_map_imu) == pytest.approx(1.0)
    assert state.p_map_imu + state.R_map_imu @ ARMS["left"] == pytest.approx([5.0, 6.0, 7.0])
    assert state.gyro_bias == pytest.approx([1e-3, 2e-3, 3e-3])
    assert np.array_equal(state.v_map_imu, np.zeros(3))
    up = state.R_map_imu.T[:, 2]
    assert up @ P[ROTATION, ROTATION] @ up == pytest.approx(np.pi**2)
    level = P[ROTATION, ROTATION] - np.pi**2 * np.outer(up, up)
    tilt_rad = NOISE.accel_bias_m_s2 / NOISE.gravity_m_s2
    assert np.linalg.eigvalsh(level)[1:] == pytest.approx([tilt_rad**2] * 2, rel=1e-6)
