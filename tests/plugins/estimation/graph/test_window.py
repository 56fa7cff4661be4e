"""The window against a general optimiser, node insertion, marginals and unsolvable equations."""

from dataclasses import replace
from types import SimpleNamespace

import gtsam
import numpy as np
import pytest
from executive_plugins.estimation.factors import fix_factor, keys, prior, velocity_factor
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph.window import GraphWindow, UnsolvableError
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState, propagate, retract

from executive.errors import DataError
from executive.geometry.rotation import from_rpy, log_so3

NOISE = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 1e-2, 9.81, 0.01)
COVARIANCE = np.diag(np.repeat([0.02, 0.1, 0.05, 1e-3, 1e-2], 3) ** 2)


@pytest.fixture
def samples() -> SampleBuffer:
    """Two seconds of a turning, accelerating IMU."""
    buffer = SampleBuffer()
    for k in range(201):
        t = k / 100
        buffer.append(
            Inertial(
                t, np.array([0.1, -0.05, 0.8 * np.sin(t)]), np.array([np.cos(t), 0.3, 9.7]), 0.01
            )
        )
    return buffer


@pytest.fixture
def first(samples) -> InertialState:
    bias = np.array([1e-3, -2e-3, 5e-4])
    return InertialState(
        samples.at(0.0), from_rpy(0.1, -0.2, 1.0), np.array([1.0, 2.0, 3.0]), bias, bias, 10 * bias
    )


def fixes(window, stamps_s, seed=0):
    """Return noisy fixes of two antennas along the window's own prediction."""
    rng = np.random.default_rng(seed)
    made = []
    for stamp_s in stamps_s:
        state = window.state_at(stamp_s)
        for arm in (np.array([1.0, 0.5, 0.3]), np.array([-1.0, 0.5, 0.3])):
            p = state.p_map_imu + state.R_map_imu @ arm + rng.normal(0, 0.01, 3)
            made.append(Fix(stamp_s, "gnss", arm, p, 1e-4 * np.eye(3)))
    return made


def add(window, fix) -> None:
    window.add("fix", fix.stamp_s, [fix_factor(window.node_at(fix.stamp_s), fix)])


def assert_same(a, b, atol) -> None:
    np.testing.assert_allclose(log_so3(a.R_map_imu.T @ b.R_map_imu), np.zeros(3), atol=atol)
    for name in ("p_map_imu", "v_map_imu", "gyro_bias", "accel_bias"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), atol=atol)


def test_preintegration_predicts_what_propagation_does(samples, first) -> None:
    window = GraphWindow(NOISE, samples, first, COVARIANCE)
    for stamp_s in (0.333, 0.7777, 1.5):  # splits samples, too
        window.node_at(stamp_s)
    state = first
    for sample in samples.between(0.0, 1.5):
        state = propagate(state, sample, 9.81)
    window.solve()  # nothing measured: any move would be preintegration against propagation
    assert_same(window.newest(), state, atol=2e-4)


def test_a_node_inserted_late_gives_the_same_result_as_in_time(samples, first) -> None:
    in_time, late = (GraphWindow(NOISE, samples, first, COVARIANCE) for _ in range(2))
    measured = fixes(in_time, (0.2, 0.4, 0.633, 0.8, 1.0))
    for fix in measured:
        add(in_time, fix)
    for fix in [*measured[:4], *measured[6:], *measured[4:6]]:
        add(late, fix)
    in_time.solve()
    late.solve()
    assert len(late) == len(in_time) == 6
    assert_same(in_time.newest(), late.newest(), atol=1e-5)
    np.testing.assert_allclose(late.covariance, in_time.covariance, rtol=0.01, atol=1e-9)


def test_marginalisation_keeps_the_estimate(samples, first) -> None:
    whole, lagged = (GraphWindow(NOISE, samples, first, COVARIANCE) for _ in range(2))
    for fix in fixes(whole, np.arange(1, 20) / 10):
        for window in (whole, lagged):
            add(window, fix)
            window.solve()
        lagged.forget_before(fix.stamp_s - 0.5)
    assert len(lagged) < 8 < len(whole)
    assert_same(whole.newest(), lagged.newest(), atol=2e-4)
    np.testing.assert_allclose(
        np.sqrt(np.diag(lagged.covariance)), np.sqrt(np.diag(whole.covariance)), rtol=0.02
    )


def test_a_prior_gives_its_covariance_back_in_our_axes(samples, first) -> None:
    rng = np.random.default_rng(1)
    root = rng.normal(0, 0.01, (15, 15))
    window = GraphWindow(NOISE, samples, first, root @ root.T)
    window.solve()
    np.testing.assert_allclose(window.covariance, root @ root.T, rtol=1e-4, atol=1e-8)


def test_a_priors_error_is_the_states_error_over_its_covariance(first) -> None:
    factor = prior(0, first, COVARIANCE)[0]
    error = np.random.default_rng(2).normal(0, 1e-4, 15)
    moved = retract(first, error)
    values = gtsam.Values()
    x, v, b = keys(0)
    values.insert(x, gtsam.Pose3(gtsam.Rot3(moved.R_map_imu), moved.p_map_imu))
    values.insert(v, moved.v_map_imu)
    values.insert(b, gtsam.imuBias.ConstantBias(moved.accel_bias, moved.gyro_bias))
    assert factor.error(values) == pytest.approx(
        0.5 * error @ np.linalg.solve(COVARIANCE, error), rel=1e-3
    )


def test_removing_fixes_restores_the_estimate_without_them(samples, first) -> None:
    window, clean = (GraphWindow(NOISE, samples, first, COVARIANCE) for _ in range(2))
    for fix in fixes(window, (0.2, 0.4)):
        add(window, fix)
        add(clean, fix)
    for fix in fixes(window, (0.6, 0.8), seed=5):
        wrong = Fix(fix.stamp_s, "gnss", fix.arm_imu, fix.p_map_antenna + 0.3, fix.covariance)
        add(window, wrong)
        clean.node_at(fix.stamp_s)
    window.solve()
    assert np.linalg.norm(window.newest().p_map_imu - clean.newest().p_map_imu) > 0.1
    window.take_back("fix", 0.5)
    window.solve()
    clean.solve()
    assert_same(
        window.newest(), clean.newest(), atol=1e-3
    )  # preintegrated about biases that were wrong for a while


def test_a_node_older_than_the_window_is_refused(samples, first) -> None:
    window = GraphWindow(NOISE, samples, first, COVARIANCE)
    with pytest.raises(DataError, match=r"begins at 0\.0 s"):
        window.node_at(-0.5)


def test_equations_that_have_no_finite_solution_are_an_error_of_their_own(samples, first) -> None:
    window = GraphWindow(NOISE, samples, first, COVARIANCE)
    node = window.node_at(0.5)
    window.add("velocity", 0.5, [velocity_factor(node, np.full(3, np.nan), 0.1)])
    with pytest.raises(UnsolvableError):
        window.solve()


def late_fixes(window, stamps_s, late_s):
    """Return fixes that were measured before their stamps."""
    return [
        replace(fix, stamp_s=stamp_s)
        for stamp_s in stamps_s
        for fix in fixes(window, (stamp_s - late_s,))
    ]


def with_clock(samples, first, std_s=0.05) -> GraphWindow:
    """Return a window whose position errs by the speed times the offset of the clock."""
    first = replace(first, v_map_imu=np.array([3.0, 0.0, 0.0]))
    return GraphWindow(NOISE, samples, first, COVARIANCE, ClockOffset(0.0, std_s))


@pytest.mark.parametrize("late_s", [-0.03, 0.0, 0.03])
def test_a_clock_is_a_state_of_the_window_and_outlasts_its_marginalisation(
    samples, first, late_s
) -> None:
    whole, lagged = (with_clock(samples, first) for _ in range(2))
    truth = with_clock(samples, first)
    for fix in late_fixes(truth, np.arange(1, 20) / 10, late_s):
        for window in (whole, lagged):
            window.add("fix", fix.stamp_s, [window.factor_of(fix)])
            window.solve()
        lagged.forget_before(fix.stamp_s - 0.5)
    assert len(lagged) < 8 < len(whole)
    for window in (whole, lagged):
        clock = window.clock
        assert clock.std_s < 0.02
        assert abs(clock.offset_s - late_s) < 3 * clock.std_s
    assert lagged.clock.offset_s == pytest.approx(whole.clock.offset_s, abs=5e-4)
    assert lagged.clock.std_s == pytest.approx(whole.clock.std_s, rel=0.05)
    np.testing.assert_allclose(lagged.clock.cross, whole.clock.cross, rtol=0.1, atol=1e-5)
    assert_same(whole.newest(), lagged.newest(), atol=5e-4)


def test_a_prior_with_a_clock_gives_back_what_they_share(samples, first) -> None:
    rng = np.random.default_rng(3)
    root = rng.normal(0, 0.01, (16, 16))
    P = root @ root.T
    clock = ClockOffset(0.02, float(np.sqrt(P[-1, -1])), P[:15, -1])
    window = GraphWindow(NOISE, samples, first, P[:15, :15], clock)
    window.solve()
    np.testing.assert_allclose(window.covariance, P[:15, :15], rtol=1e-4, atol=1e-8)
    np.testing.assert_allclose(window.clock.cross, clock.cross, rtol=1e-4, atol=1e-8)
    assert (window.clock.offset_s, window.clock.std_s) == pytest.approx((0.02, clock.std_s))


# Biases of accelerometer and gyro, velocity, rotation, position, in GTSAM's order of a step.
LINEAR = (0.02, 2e-3, 0.03, 6e-4, 1.5e-3)


@pytest.mark.parametrize("component", range(15))
@pytest.mark.parametrize(("share", "is_far"), [(0.99, False), (1.01, True), (-1.01, True)])
def test_factors_are_linearised_again_where_a_node_is_too_far_from_their_point(
    samples, first, monkeypatch, component, share, is_far
) -> None:
    window = GraphWindow(NOISE, samples, first, COVARIANCE)
    step = np.zeros(15)
    step[component] = share * LINEAR[component // 3]
    moved, voided = [{0}, set()], []
    monkeypatch.setattr(window, "_iterate", lambda: moved.pop(0))
    monkeypatch.setattr(window, "_void", lambda factors: voided.extend(factors))
    window._values.steps[0] = SimpleNamespace(vector=lambda: step)
    window.solve()
    assert bool(voided) is is_far
    assert all(0 in factor.nodes for factor in voided)


def test_a_window_that_does_not_settle_is_left_after_six_rounds(
    samples, first, monkeypatch
) -> None:
    window, rounds = GraphWindow(NOISE, samples, first, COVARIANCE), []
    window._values.steps[0] = SimpleNamespace(vector=lambda: np.ones(15))
    monkeypatch.setattr(window, "_iterate", lambda: rounds.append(1) or {0})
    monkeypatch.setattr(window, "_void", list)
    window.solve()
    assert len(rounds) == 6
