"""Which start gives the first state, with a rest and a window that answer as the test says."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import GYRO_BIAS, Inertial, InertialState
from executive_plugins.estimation.start.first_state import FirstState
from executive_plugins.estimation.start.settings import RestSettings, WindowStartSettings

NOISE = InertialNoise(4e-4, 4e-3, 2e-5, 3e-4, 0.03, 9.81, 0.01)
ARMS = {"left": np.array([-1.0, 1.0, 1.2]), "right": np.array([-1.0, -1.0, 1.2])}
BIAS = np.array([0.01, 0.02, 0.03])


class Rest:
    """Finds rest or none, and says what it waits for."""

    def __init__(self) -> None:
        self.found, self.waits_for, self.moves = None, "rest to be found", False
        self.tried = 0
        self.samples, self.fixes = [], []

    def add_sample(self, sample) -> None:
        self.samples.append(sample)

    def add_fix(self, *fix) -> None:
        self.fixes.append(fix)

    def state(self):
        self.tried += 1
        return self.found

    def unrest_rad_s(self) -> float:
        return 0.002


class Window:
    """Always has an answer of its own."""

    def __init__(self) -> None:
        self.waits_for, self.samples, self.fixes, self.rests = "", [], [], []

    def add_sample(self, sample) -> None:
        self.samples.append(sample)

    def add_fix(self, fix) -> None:
        self.fixes.append(fix)

    def take_rest(self, rate, std_rad_s) -> None:
        self.rests.append((rate.tolist(), std_rad_s))

    def state(self) -> str:
        return "by the window"


def start(antennas: int = 2) -> FirstState:
    arms = dict(list(ARMS.items())[:antennas])
    settings = RestSettings(duration_s=2.0, max_rate_rad_s=0.02)
    window = WindowStartSettings(max_heading_std_rad=0.15)
    made = FirstState(settings, window, arms, NOISE, None, clock_std_s=0.25)
    made._rest, made._window = Rest(), Window()
    return made


def sample(stamp_s: float) -> Inertial:
    return Inertial(stamp_s, np.zeros(3), np.array([0.0, 0.0, 9.81]), 0.01)


def resting(stamp_s: float, heading_std_rad: float, bias_std: float = 0.003):
    """Return a level state at rest, whose heading and bias are as uncertain as said."""
    state = InertialState(
        sample(stamp_s), np.eye(3), np.zeros(3), np.zeros(3), stamp_s * BIAS, np.zeros(3)
    )
    P = 1e-4 * np.eye(15)
    P[2, 2] = heading_std_rad**2
    P[GYRO_BIAS, GYRO_BIAS] = np.diag([1e-4, 1.0, 1e-6]) * bias_std**2
    return state, P


def test_a_rest_with_a_heading_is_the_first_state() -> None:
    first = start()
    assert first.waits_for == ""
    assert first.add_sample(sample(0.0), 0.0) is None
    assert first.waits_for == "rest to be found"
    first._rest.found = resting(0.2, 0.149)
    found = first.add_sample(sample(0.2), 0.0)
    assert (found.state, found.covariance) == first._rest.found
    assert (found.has_heading, found.fix_scale) == (True, 1.0)
    assert (found.clock.offset_s, found.clock.std_s) == (0.0, 0.25)
    assert [one.stamp_s for one in first._rest.samples] == [0.0, 0.2]
    assert first._window.samples == first._rest.samples


def test_rest_is_looked_for_ten_times_a_second() -> None:
    first = start()
    for k in range(30):  # every 0.03125 s: each fourth one is 0.125 s after the last attempt
        first.add_sample(sample(k / 32), 0.0)
    assert first._rest.tried == 8


@pytest.mark.parametrize("rate_rad_s", [0.021, -0.021])
def test_a_cabin_that_turns_is_not_at_rest_and_the_window_begins(rate_rad_s: float) -> None:
    first = start()
    assert first.add_sample(sample(0.0), np.sign(rate_rad_s) * 0.019) is None
    assert first.add_sample(sample(0.2), rate_rad_s) == "by the window"
    assert first._rest.tried == 1
    assert first.waits_for == "rest: the cabin turns on its chassis at 0.021 rad/s"
    assert first.add_sample(sample(0.25), 0.0) is None  # it is tried again, and waited for
    assert first._rest.tried == 2
    first._window.waits_for = "motion"
    first.add_sample(sample(0.5), rate_rad_s)
    assert first.waits_for == "motion"


def test_rest_is_waited_for_three_times_as_long_as_it_lasts() -> None:
    """Counted from the earliest sample, for a body with two antennas that does not move."""
    first = start()
    for stamp_s in (1.0, 3.0, 7.0):
        assert first.add_sample(sample(stamp_s), 0.0) is None
    assert first.add_sample(sample(7.01), 0.0) == "by the window"
    moving = start()
    moving._rest.moves = True
    assert moving.add_sample(sample(1.0), 0.0) == "by the window"
    single = start(antennas=1)
    assert single.add_sample(sample(1.0), 0.0) == "by the window"


def test_a_rest_without_a_heading_tells_the_window_the_bias() -> None:
    """Each two seconds of rest once: the larger of its noise and its unrest, the mean of rates."""
    first = start()
    for stamp_s, bias_std in ((1.0, 0.003), (2.0, 0.003), (3.5, 0.001)):
        first._rest.found = resting(stamp_s, 0.151, bias_std)
        assert first.add_sample(sample(stamp_s), 0.0) == "by the window"
    (one, std), (mean, spread) = first._window.rests
    assert one == pytest.approx(BIAS.tolist())
    assert std == pytest.approx(0.003)
    assert mean == pytest.approx((2.25 * BIAS).tolist())
    assert spread == pytest.approx(2.5 * 0.03 / np.sqrt(2))
    first._rest.found = None  # the fixes still do not tell the heading: nothing is waited for
    assert first.add_sample(sample(3.7), 0.0) == "by the window"
    quiet = start()
    quiet._rest.found = resting(1.0, 0.151, 0.001)
    quiet.add_sample(sample(1.0), 0.0)
    assert quiet._window.rests[0][1] == pytest.approx(0.002)


def test_a_fix_is_given_to_both() -> None:
    first, place = start(), np.array([1.0, 2.0, 3.0])
    covariance = np.diag([1e-4, 9e-4, 4e-4])
    first.add_fix(4.5, "right", place, covariance)
    ((stamp_s, antenna, p, std_m),) = first._rest.fixes
    assert (stamp_s, antenna, p.tolist()) == (4.5, "right", [1.0, 2.0, 3.0])
    assert std_m == pytest.approx(0.03)  # that of the worst axis
    (fix,) = first._window.fixes
    assert (fix.stamp_s, fix.antenna, fix.arm_imu.tolist()) == (4.5, "right", [-1.0, -1.0, 1.2])
    assert fix.p_map_antenna is place
    assert fix.covariance is covariance
