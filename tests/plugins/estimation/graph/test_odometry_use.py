"""Odometry beside fixes once a second: the graph without it is reported once it has failed."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix, Increment
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.smoother import GraphSmoother
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.modes import Mode

NOISE = InertialNoise(1e-4, 0.3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
UP = np.array([0.0, 0.0, 9.81])
Z = np.zeros(3)
FIX_STD_M = 0.01
ODOMETRY = np.diag(np.repeat([1e-6, 0.005**2], 3))
STEP_M = 0.05  # near enough to the prediction between two fixes to pass the gate of increments


class Parked:
    """A body at rest with an accelerometer that says little, and odometry that may say it moves."""

    def __init__(self) -> None:
        state = InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), Z, Z, Z, Z)
        self.smoother = GraphSmoother(
            SmootherSettings(), NOISE, GraphEstimate(state, 1e-4 * np.eye(15))
        )
        self.k, self.answers = 0, []

    def until(self, stamp_s: float, step_m: float | None, has_fixes: bool = True) -> None:
        """Go on with ten increments a second that are too long, if any, and a fix a second."""
        while self.k < round(100 * stamp_s):
            self.k += 1
            now_s, smoother = self.k / 100, self.smoother
            smoother.add_sample(Inertial(now_s, Z, UP, 0.01))
            if has_fixes and self.k % 100 == 0:
                smoother.add(Fix(now_s, "left", Z, Z, FIX_STD_M**2 * np.eye(3)))
            if step_m is not None and self.k % 10 == 0:
                T = np.eye(4)
                T[0, 3] = step_m
                smoother.add(Increment(now_s - 0.1, now_s, T, ODOMETRY))
            if smoother.is_due:
                self.answers.append(smoother.update())

    @property
    def pair(self):
        """Both graphs."""
        return self.smoother._odometry.pair

    @property
    def is_trusted(self) -> bool:
        """Whether the state that is reported uses odometry."""
        return self.smoother._odometry.is_trusted

    def off_m(self, after_s: float) -> float:
        """Return the largest error of a state that was reported after a time."""
        states = [answer.state for answer in self.answers if answer.state.stamp_s > after_s]
        return max(float(np.linalg.norm(state.p_map_imu)) for state in states)

    def refusals(self) -> int:
        """Return the number of fixes that were refused."""
        return sum(answer.refused.get("left: outlier", 0) for answer in self.answers)


def test_odometry_that_moves_misleads_until_the_next_fix_at_most() -> None:
    """Ten increments of 5 cm, and not 80."""
    parked = Parked()
    parked.until(4.0, 0.0)
    assert parked.is_trusted
    parked.until(12.0, STEP_M)
    assert not parked.is_trusted
    assert parked.off_m(4.0) < 10 * STEP_M
    assert parked.off_m(5.1) < 3 * FIX_STD_M + 0.02
    assert parked.answers[-1].mode == Mode.GLOBAL
    assert parked.refusals() == 0


@pytest.mark.parametrize("step_m", [0.004, 0.008, 0.02])
def test_odometry_that_drifts_slowly_does_not_mislead_both_graphs(step_m: float) -> None:
    """Of 4 to 20 cm a second; the fixes contradict one graph, and agree with the other."""
    parked = Parked()
    parked.until(15.0, step_m)
    assert not parked.is_trusted
    assert parked.off_m(6.0) < 3 * FIX_STD_M
    assert parked.refusals() == 0


def test_odometry_is_used_again_after_it_has_agreed_for_long_enough() -> None:
    parked = Parked()
    parked.until(4.0, 0.0)
    parked.until(7.0, STEP_M)
    parked.until(12.0, 0.0)
    assert not parked.is_trusted
    parked.until(20.0, 0.0)
    assert parked.is_trusted


def test_without_fixes_odometry_is_used_whatever_it_has_shown() -> None:
    parked = Parked()
    parked.until(4.0, 0.0)
    parked.until(7.0, STEP_M)
    parked.until(12.0, 0.0, has_fixes=False)
    assert parked.answers[-1].mode == Mode.FALLBACK
    assert parked.is_trusted
    assert parked.pair.other is None
    assert parked.off_m(7.1) < 1.0  # by the accelerometer alone, its deviation is 2 m


def test_there_is_a_second_graph_only_while_the_window_holds_odometry() -> None:
    parked = Parked()
    parked.until(3.0, None)
    assert parked.pair.other is None
    parked.until(5.0, 0.0)
    assert parked.pair.other is not None
    parked.until(7.9, None)
    assert parked.pair.other is not None
    parked.until(9.1, None)
    assert parked.pair.other is None


def test_sound_odometry_separates_nothing() -> None:
    rng, parked = np.random.default_rng(5), Parked()
    for k in range(1, 80):
        parked.until(0.1 * k, rng.normal(0.0, 0.005))
    assert parked.is_trusted
    assert parked.pair.other is not None
    assert parked.pair.separation2() < 9 + 3 * np.sqrt(18)  # χ² of nine: mean, three deviations


@pytest.mark.parametrize("drift", [0.01, 0.1])
def test_an_increment_counts_with_a_drift_since_the_last_fix(drift: float) -> None:
    """Ten increments that err by the same share are off by that share of the whole way."""
    state = InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), Z, Z, Z, Z)
    settings = SmootherSettings(gate={"odometry_drift": drift})
    use = GraphSmoother(settings, NOISE, GraphEstimate(state, np.eye(15)))._odometry
    T = np.eye(4)
    T[0, 3] = 0.2
    some = [Increment(0.1 * (k - 1), 0.1 * k, T, ODOMETRY) for k in range(1, 11)]
    added = [use._with_drift(one, one.stamp_s).covariance - ODOMETRY for one in some]
    assert sum(added)[3:, 3:] == pytest.approx((10 * drift * 0.2) ** 2 * np.eye(3))
    assert np.all(sum(added)[:3] == 0.0)
