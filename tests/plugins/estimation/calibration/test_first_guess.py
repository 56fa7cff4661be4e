"""What a calibration begins with: samples, fixes, and states that are carried back in time."""

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.calibration.first_guess import FirstGuess, _telling
from executive_plugins.estimation.calibration.settings import KeyframeBatchSettings
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.inertial.state import Inertial, InertialState, propagate

from executive.errors import DataError
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.rotation import from_rpy
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

DATUM = np.array([47.4, 8.5, 440.0])
STILL = np.array([0.0, 0.0, 9.81])


@pytest.fixture
def guess(machine) -> FirstGuess:
    made = FirstGuess(KeyframeBatchSettings(datum=None), machine)
    made.start()
    return made


def fix(stamp_s: float, enu=(0.0, 0.0, 0.0), std_m: float = 0.02, antenna: str = "gnss_left"):
    geodetic = geodetic_from_enu(np.array(enu), DATUM)
    return GnssFix(stamp_s, antenna, geodetic, std_m**2 * np.eye(3), True)


def imu(stamp_s: float, rate: float = 0.0) -> ImuSample:
    return ImuSample(stamp_s, "imu_cabin", np.array([0.0, 0.0, rate]), STILL)


@pytest.fixture
def fed(monkeypatch: pytest.MonkeyPatch) -> list[GnssFix]:
    """What the filter itself is given."""
    given: list[GnssFix] = []
    monkeypatch.setattr(GnssImuFilter, "add_gnss", lambda own, one: given.append(one))
    return given


@pytest.mark.parametrize(("apart_m", "used"), [(0.79, ["left"]), (0.83, ["left", "right"])])
def test_antennas_tell_the_heading_if_their_arms_may_not_turn_it_round(apart_m, used) -> None:
    """Three deviations of both arms, 1.27 m across, turn 0.81 m by a quarter of a turn [rad]."""
    arms = {"left": np.array([1.0, 0.0, 2.0]), "right": np.array([1.0, -apart_m, 2.0])}
    assert list(_telling(arms, 0.3)) == used
    assert _telling({"left": arms["left"]}, 0.3).keys() == {"left"}


def test_fixes_of_antennas_that_are_close_are_kept_all_the_same(machine, fed) -> None:
    guess = FirstGuess(KeyframeBatchSettings(datum=None, arm_std_m=10.0), machine)
    guess.start()
    feed(guess, fix(1.0), fix(1.0, antenna="gnss_right"))
    assert [one.antenna for one in guess.fixes] == ["gnss_left", "gnss_right"]
    assert list(guess._antennas_imu) == ["gnss_left"]


def feed(guess: FirstGuess, *observations: object) -> None:
    """Feed less than what a state with a heading needs."""
    with pytest.raises(DataError, match="calibration found no motion to begin with"):
        guess.feed(observations)


def test_fixes_are_kept_as_declared_and_filtered_as_uncertain_as_arms(guess, fed) -> None:
    first, second = fix(1.0), fix(2.0, (3.0, -4.0, 0.5))
    nowhere = fix(3.0, std_m=0.0)
    feed(guess, first, fix(1.5, antenna="gnss_unknown"), nowhere, second)
    assert [(one.stamp_s, one.antenna) for one in guess.fixes] == [
        (1.0, "gnss_left"),
        (2.0, "gnss_left"),
    ]
    assert guess.fixes[0].p_map_antenna == pytest.approx(np.zeros(3), abs=1e-6)  # the map's origin
    assert guess.fixes[1].p_map_antenna == pytest.approx([3.0, -4.0, 0.5], abs=1e-3)
    assert guess.fixes[1].covariance == pytest.approx(4e-4 * np.eye(3))
    sensors = guess._machine.sensors
    arm_link = sensors["gnss_left"].T_link_sensor[:3, 3]
    T_link_imu = sensors["imu_cabin"].T_link_sensor
    assert T_link_imu[:3, :3] @ guess.fixes[0].arm_imu + T_link_imu[:3, 3] == pytest.approx(
        arm_link
    )
    assert [one.stamp_s for one in fed] == [1.0, 1.5, 3.0, 2.0]
    assert fed[0].covariance_enu_m2 == pytest.approx((4e-4 + 0.3**2) * np.eye(3))


def test_samples_that_the_filter_refuses_are_left_out(guess) -> None:
    """Older ones, repeated ones and those beyond the sensor's range."""
    wild = ImuSample(0.05, "imu_cabin", np.array([99.0, 0.0, 0.0]), STILL)
    elsewhere = ImuSample(0.055, "imu_base", np.zeros(3), STILL)
    step = LidarIncrement(0.0, 0.1, "lidar", np.eye(4), np.eye(6))
    feed(guess, imu(0.02, 0.1), imu(0.04, 0.2), imu(0.03), wild, elsewhere, step, imu(0.06, 0.3))
    kept = list(guess.samples)
    assert [one.stamp_s for one in kept] == [0.02, 0.04, 0.06]
    assert [one.since_last_s for one in kept] == pytest.approx([0.0, 0.02, 0.02])
    assert [one.rate[2] for one in kept] == [0.1, 0.2, 0.3]
    assert [one.force.tolist() for one in kept] == [STILL.tolist()] * 3
    assert guess.increments == [step]
    assert (guess.states, guess.clock_s) == ([], 0.0)


def test_the_refusal_says_what_the_start_waits_for(guess) -> None:
    with pytest.raises(DataError) as nothing:
        guess.feed([])
    assert str(nothing.value) == (
        "calibration found no motion to begin with: it needs fixes, and motion that tells "
        "the heading"
    )
    with pytest.raises(DataError, match=r"the heading; it waits for ") as waiting:
        guess.feed([imu(0.01 * k) for k in range(1, 700)])
    assert str(waiting.value).endswith(guess.account()[-1].reason)


def trailing(state: InertialState, clock_s: float = 0.0) -> SimpleNamespace:
    return SimpleNamespace(
        kalman=SimpleNamespace(state=state, clock_s=clock_s),
        add_sample=lambda sample: None,
        follow=lambda: None,
    )


@pytest.fixture
def at() -> Callable[[float], InertialState]:
    zero = np.zeros(3)

    def at(stamp_s: float) -> InertialState:
        return InertialState(Inertial(stamp_s, zero, STILL), np.eye(3), zero, zero, zero, zero)

    return at


def test_each_new_state_of_the_filter_is_kept_once(guess, at) -> None:
    states = [at(0.01), at(0.01), at(0.02), at(0.015), at(0.03)]
    for k, state in enumerate(states):
        guess._trailing = trailing(state, 0.01 * k)
        if k == 0:  # one state is no motion yet
            feed(guess, imu(0.1))
        elif len(guess.states) < 2 and k == 1:
            feed(guess, imu(0.12))
        else:
            guess.feed([imu(0.1 + 0.02 * k)])
    assert [one.stamp_s for one in guess.states] == [0.01, 0.02, 0.03]
    assert guess.clock_s == 0.04


def test_states_are_carried_back_to_the_first_sample(guess) -> None:
    """Carried on again by the same samples, they end at the state that the filter began with."""
    rng, samples = np.random.default_rng(2), []
    for k in range(12):
        rate, force = rng.normal(0, 0.8, 3), STILL + rng.normal(0, 2.0, 3)
        samples.append(Inertial(0.02 * k, rate, force, 0.02))
        guess.samples.append(samples[-1])
    bias = np.array([0.01, -0.02, 0.03])
    zero = InertialState(
        samples[0], from_rpy(0.2, -0.1, 1.0), np.ones(3), np.array([1.0, 2.0, 3.0]), bias, 2 * bias
    )
    states = [zero]
    for sample in samples[1:]:
        states.append(propagate(states[-1], sample, guess._cabin.gravity_m_s2))
    guess.states = states[8:]
    track = guess.track()
    assert track[8:] == states[8:]
    assert [one.stamp_s for one in track] == [one.stamp_s for one in states]
    for found, true in zip(track, states, strict=True):
        assert found.sample is true.sample
        for name in ("R_map_imu", "p_map_imu", "v_map_imu", "gyro_bias", "accel_bias"):
            assert getattr(found, name) == pytest.approx(getattr(true, name), abs=1e-9)
