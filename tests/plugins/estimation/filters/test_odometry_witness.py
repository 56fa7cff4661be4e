"""Odometry beside a filter that walks by 1 m/s: what contradicts it, and what does not."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.filters.inertial_way import KeptFilter
from executive_plugins.estimation.filters.odometry_witness import OdometryWitness
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.live.layout import SAMPLE

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3
from executive.messages.odometry import LidarIncrement

SPEED_M_S, FROM_S, PERIOD_S = 1.0, 15.0, 0.1
IMU_PERIOD_S = 0.01
STD_M, STD_RAD = 0.002, 0.0005  # of an increment
VARIANCES = np.repeat([1e-3, 3e-2, 1e-2, 1e-4, 1e-3], 3) ** 2
FAR = 14.2  # three standard deviations of three values


class Walk:
    """A filter that is off by what a function of time says, and a witness of its motion."""

    def __init__(self, off_m=lambda _: np.zeros(3), off_rad=lambda _: 0.0, way=lambda _: 1.0):
        self.off_m, self.off_rad, self.way = off_m, off_rad, way
        self.samples = SimpleNamespace(ring=np.zeros(4096, SAMPLE), samples=0)
        self.witness = OdometryWitness(10.0, self.samples)
        self.rng = np.random.default_rng(4)

    def true(self, at_s):
        turn = exp_so3(np.array([0.0, 0.0, 0.3 * np.sin(0.4 * at_s)]))
        return pose(turn, np.array([SPEED_M_S * at_s, 0.0, 0.0]))

    def kalman(self, at_s):
        T, Z = self.true(at_s), np.zeros(3)
        R = exp_so3(np.array([0.0, 0.0, self.off_rad(at_s)])) @ T[:3, :3]
        sample = Inertial(at_s, Z, np.array([0.0, 0.0, 9.81]), 0.01)
        v = np.array([SPEED_M_S, 0.0, 0.0])
        state = InertialState(sample, R, T[:3, 3] + self.off_m(at_s), v, Z, Z)
        noise = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 0.1, 9.81, 0.01)
        return ErrorStateFilter(state, np.diag(VARIANCES), noise)

    def sample_until(self, at_s):
        """Let sound inertial samples arrive."""
        while (stamp_s := round((self.samples.samples + 1) * IMU_PERIOD_S, 6)) <= at_s:
            rate = [0.0, 0.0, 0.12 * np.cos(0.4 * (stamp_s - IMU_PERIOD_S / 2))]
            place = self.samples.samples % len(self.samples.ring)
            self.samples.ring[place] = (stamp_s, IMU_PERIOD_S, rate, [0.0, 0.0, 9.81])
            self.samples.samples += 1

    def kept(self, at_s):
        self.sample_until(at_s)
        return KeptFilter(self.kalman(at_s).block.copy(), self.samples.samples)

    def increment(self, at_s):
        T = inverse(self.true(at_s - PERIOD_S)) @ self.true(at_s)
        turn = exp_so3(self.rng.normal(0, STD_RAD, 3))
        way = self.way(at_s) * T[:3, 3] + self.rng.normal(0, STD_M, 3)
        covariance = np.diag(np.repeat([STD_RAD, STD_M], 3) ** 2)
        from_s, T = round(at_s - PERIOD_S, 6), pose(T[:3, :3] @ turn, way)
        return LidarIncrement(from_s, at_s, "lidar", T, covariance)

    def until(self, end_s, is_sound=True):
        """Yield the time and the witness after each increment."""
        for k in range(1, round(end_s / PERIOD_S)):
            at_s = round(k * PERIOD_S, 6)
            self.witness.take(self.kept(at_s), self.increment(at_s), is_sound)
            yield at_s, self.witness


def since(at_s):
    return max(0.0, at_s - FROM_S)


def drifting(at_s):
    return 0.1 * since(at_s) * np.array([0.8, 0.6, 0.0])


def test_the_size_of_what_differs_is_kept_with_it() -> None:
    """Ways differ first, and turns as well later; sound odometry has no size at all."""
    sizes = []
    for _, witness in Walk(drifting, lambda at_s: 0.02 * since(at_s)).until(20.0):
        sizes.append(witness.size2)
        assert witness.size2 == np.trace(witness.moved2) + np.trace(witness.turned2)
    assert sizes[100] == 0.0
    assert np.trace(witness.moved2) > 0.0
    assert np.trace(witness.turned2) > 0.0
    witness.forget()
    assert witness.size2 == 0.0


def test_sound_odometry_contradicts_nothing() -> None:
    assert not any(witness.is_apart for _, witness in Walk().until(40.0))


def test_odometry_that_has_always_drifted_contradicts_nothing() -> None:
    """Its way is 2 % too long: twice the usual drift."""
    assert not any(witness.is_apart for _, witness in Walk(way=lambda _: 1.02).until(40.0))


def test_a_state_that_follows_fixes_which_drift_is_less_certain() -> None:
    """0.1 m/s is a tenth of the way; both explain it, and the covariance holds both."""
    noticed_s = np.inf
    for at_s, witness in Walk(off_m=drifting).until(FROM_S + 10.0):
        if witness.is_apart:
            noticed_s = min(noticed_s, at_s)
            off_m = drifting(at_s)
            # Of 10 s, as much as began in the window is known.
            assert off_m @ np.linalg.solve(witness.moved2, off_m) < FAR
    assert FROM_S < noticed_s < FROM_S + 3.0


def test_an_error_that_is_likely_counts_before_it_is_proven() -> None:
    """The covariance holds it before chance is ruled out, and nothing before it began."""
    likely_s = apart_s = np.inf
    for at_s, witness in Walk(off_m=drifting).until(FROM_S + 3.0):
        assert at_s > FROM_S or not witness.moved2.any()
        if witness.moved2.any() and not witness.is_apart:
            off_m = drifting(at_s)
            if off_m @ np.linalg.pinv(witness.moved2) @ off_m < FAR:
                likely_s = min(likely_s, at_s)
        if witness.is_apart:
            apart_s = min(apart_s, at_s)
    assert likely_s < apart_s


def test_a_filter_that_fixes_draw_along_does_not_refute_odometry() -> None:
    """It moves otherwise than odometry, as fast as no noise explains; samples say which errs."""
    walk = Walk(off_m=lambda at_s: 0.4 * since(at_s) * np.array([0.8, 0.6, 0.0]))
    seen = [(at_s, witness.is_apart) for at_s, witness in walk.until(FROM_S + 8.0)]
    assert all(is_apart for at_s, is_apart in seen if at_s > FROM_S + 1.0)


def test_an_error_stays_held_when_the_windows_show_a_part_of_it() -> None:
    """It grew to 1 m within two seconds, and the newest ten seconds show the last 0.35 m."""

    def jumped(at_s):
        return 0.5 * min(since(at_s), 2.0) * np.array([0.8, 0.6, 0.0])

    *_, (at_s, witness) = Walk(off_m=jumped).until(FROM_S + 11.3 + PERIOD_S)
    assert jumped(at_s) @ np.linalg.solve(witness.moved2, jumped(at_s)) < 2.0


def test_a_turn_that_odometry_did_not_measure_is_told_apart_from_a_way() -> None:
    walk = Walk(off_rad=lambda at_s: 0.05 * since(at_s))
    *_, (_, witness) = walk.until(FROM_S + 3.0)
    assert witness.is_apart
    assert np.sqrt(witness.turned2[2, 2]) == pytest.approx(0.15, abs=0.06)


def test_odometry_that_inertial_samples_refute_contradicts_nothing() -> None:
    """A velocity that is wrong by 1 m/s at once is no drift of the fixes."""
    walk = Walk(way=lambda at_s: 2.0 if at_s > FROM_S else 1.0)
    seen = [(at_s, witness.is_apart) for at_s, witness in walk.until(FROM_S + 10.0)]
    assert not any(is_apart for at_s, is_apart in seen if at_s > FROM_S + 0.5)


def test_a_state_in_doubt_refutes_no_odometry() -> None:
    walk = Walk(way=lambda at_s: 2.0 if at_s > FROM_S else 1.0)
    assert any(witness.is_apart for _, witness in walk.until(FROM_S + 3.0, is_sound=False))


def test_a_contradiction_ends_once_it_is_older_than_what_is_remembered() -> None:
    def ended(at_s):
        return drifting(min(at_s, FROM_S + 5.0))

    *_, (_, witness) = Walk(off_m=ended).until(FROM_S + 16.0)
    assert not witness.is_apart
    assert not witness.moved2.any()


def test_a_gap_in_the_odometry_begins_anew() -> None:
    walk = Walk(off_m=drifting)
    *_, (_, witness) = walk.until(FROM_S + 5.0)
    assert witness.is_apart
    at_s = FROM_S + 6.0
    witness.take(walk.kept(at_s), walk.increment(at_s), True)
    assert not witness.is_apart
    assert not witness.moved2.any()
