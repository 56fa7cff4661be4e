"""The compiled inertial path against the same equations in matrices."""

import pickle

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    POSITION,
    ROTATION,
    Inertial,
    InertialState,
    carry_covariance,
    propagate_through,
)
from executive_plugins.estimation.live.layout import SAMPLES
from executive_plugins.estimation.live.packing import packed
from executive_plugins.estimation.live.propagator import GAP, OUT_OF_RANGE, LivePropagator
from executive_plugins.estimation.start.chassis import TurnJoint

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3, skew
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample

NOISE = InertialNoise(2e-3, 3e-2, 4e-4, 5e-3, 0.1, 9.81, 0.01)
T_IMU_CABIN = pose(exp_so3(np.array([0.4, -0.2, 1.1])), np.array([0.3, -0.8, 0.5]))


@pytest.fixture
def turn(machine) -> TurnJoint:
    turn = TurnJoint(machine)
    names = machine.joint_names
    position, velocity = np.zeros(len(names)), np.zeros(len(names))
    index = names.index(machine.turn_joint)
    position[index], velocity[index] = 0.7, -0.3
    turn.update(JointSample(1.0, names, position, velocity, np.zeros(len(names))))
    return turn


@pytest.fixture
def propagator(turn) -> LivePropagator:
    return LivePropagator(T_IMU_CABIN, turn, NOISE, gap_s=5.0)


def some_state(rng: np.random.Generator, stamp_s: float = 1.0) -> InertialState:
    sample = Inertial(stamp_s, rng.normal(0, 0.3, 3), np.array([0.5, -1.0, 9.5]))
    return InertialState(
        sample,
        exp_so3(rng.normal(0, 1, 3)),
        *rng.normal(0, 1, (2, 3)),
        *rng.normal(0, 0.05, (2, 3)),
    )


def some_samples(rng: np.random.Generator, count: int, begin_s: float = 1.0) -> list[Inertial]:
    return [Inertial(begin_s + k / 100, *rng.normal(0, 1, (2, 3))) for k in range(1, count + 1)]


def go(propagator: LivePropagator, samples: list[Inertial]) -> None:
    for sample in samples:
        assert propagator.step(sample.stamp_s, sample.rate, sample.force) == 0


def T_map_imu(state: InertialState) -> np.ndarray:
    return pose(state.R_map_imu, state.p_map_imu)


def test_steps_follow_the_strapdown_equations_and_reports_compose_poses(propagator, turn) -> None:
    rng = np.random.default_rng(1)
    state, samples = some_state(rng), some_samples(rng, 7)
    propagator.take(packed(state, np.eye(15)))
    go(propagator, samples)
    end, said = propagate_through(state, samples, 9.81), propagator.state("GLOBAL")
    np.testing.assert_allclose(said.T_map_cabin, T_map_imu(end) @ T_IMU_CABIN, atol=1e-12)
    np.testing.assert_allclose(
        said.T_map_base, said.T_map_cabin @ turn.T_cabin_base(1.07), atol=1e-12
    )
    np.testing.assert_allclose(
        said.T_odom_base, said.T_map_base, atol=1e-12
    )  # nothing has been corrected
    h = 1e-6  # velocity and turn rate of a point of a body: by finite differences of a small motion
    after = (
        pose(end.R_map_imu @ exp_so3(h * end.rate), end.p_map_imu + h * end.v_map_imu) @ T_IMU_CABIN
    )
    np.testing.assert_allclose(said.v_map_cabin, (after - said.T_map_cabin)[:3, 3] / h, atol=1e-4)
    np.testing.assert_allclose(
        said.T_map_cabin[:3, :3] @ said.w_map_cabin_in_cabin, end.R_map_imu @ end.rate
    )
    assert (said.stamp_s, said.status) == (samples[-1].stamp_s, "GLOBAL")


def test_the_covariance_is_propagated_and_expressed_at_the_cabin(propagator) -> None:
    rng = np.random.default_rng(2)
    state, samples = some_state(rng), some_samples(rng, 12)
    root = rng.normal(0, 0.1, (15, 15))
    propagator.take(packed(state, root @ root.T))
    go(propagator, samples[:1])
    for count in range(2, 12):
        go(propagator, samples[count - 1 : count])
        propagator.state("")
    end = propagate_through(state, samples[:11], 9.81)  # it is found at samples 1, 6 and 11
    P = carry_covariance(state, root @ root.T, NOISE, end.stamp_s - state.stamp_s)
    R, arm = T_IMU_CABIN[:3, :3].T, T_IMU_CABIN[:3, 3]
    J = np.zeros((6, 6))
    # A constant rate carries the covariance; its rotations are in the axes which that rate gives.
    steady = state.R_map_imu @ exp_so3((end.stamp_s - state.stamp_s) * state.rate)
    turn = end.R_map_imu.T @ steady
    J[:3, :3], J[3:, :3], J[3:, 3:] = R @ turn, -R @ skew(arm) @ turn, R @ end.R_map_imu.T
    pick = np.r_[ROTATION, POSITION]
    np.testing.assert_allclose(
        propagator.state("").covariance, J @ P[np.ix_(pick, pick)] @ J.T, rtol=1e-9, atol=1e-12
    )


def test_a_past_estimate_is_propagated_and_only_the_map_frame_steps(propagator) -> None:
    rng = np.random.default_rng(3)
    state, samples = some_state(rng), some_samples(rng, 10)
    propagator.take(packed(state, np.eye(15)))
    go(propagator, samples)
    before = propagator.state("")
    other = some_state(rng, stamp_s=1.043)  # between two samples
    assert propagator.take(packed(other, np.eye(15)))
    after = propagator.state("")
    end = propagate_through(other, samples[4:], 9.81)
    np.testing.assert_allclose(after.T_map_cabin, T_map_imu(end) @ T_IMU_CABIN, atol=1e-12)
    np.testing.assert_allclose(after.T_odom_base, before.T_odom_base, atol=1e-12)
    assert np.linalg.norm((after.T_map_base - before.T_map_base)[:3, 3]) > 0.1
    T_map_odom = after.T_map_base @ inverse(after.T_odom_base)  # Nubert 2022, Eq. (11)
    expected = after.T_map_base @ inverse(before.T_map_base)
    np.testing.assert_allclose(T_map_odom, expected, atol=1e-12)


def test_more_samples_than_the_ring_holds_change_nothing(propagator) -> None:
    rng = np.random.default_rng(4)
    state = some_state(rng)
    propagator.take(packed(state, np.eye(15)))
    samples = [
        Inertial(1.0 + k / 400, np.zeros(3), np.array([0, 0, 9.81]))
        for k in range(1, SAMPLES + 300)
    ]
    go(propagator, samples)
    late = some_state(rng, stamp_s=samples[-201].stamp_s)
    propagator.take(packed(late, np.eye(15)))
    end = propagate_through(late, samples[-200:], 9.81)
    np.testing.assert_allclose(
        propagator.state("").T_map_cabin, T_map_imu(end) @ T_IMU_CABIN, atol=1e-9
    )
    assert propagator.samples == len(samples)


def test_a_joint_sample_after_an_inertial_sample_changes_its_report(
    propagator, turn, machine
) -> None:
    propagator.take(packed(some_state(np.random.default_rng(5)), np.eye(15)))
    go(propagator, some_samples(np.random.default_rng(6), 2))
    before = propagator.state("")
    names, zeros = machine.joint_names, np.zeros(len(machine.joint_names))
    turn.update(JointSample(1.02, names, zeros + 0.9, zeros, zeros))
    propagator.set_turn()
    np.testing.assert_allclose(
        propagator.state("").T_map_base, before.T_map_cabin @ turn.T_cabin_base(1.02), atol=1e-12
    )
    np.testing.assert_array_equal(propagator.state("").T_map_cabin, before.T_map_cabin)


@pytest.mark.parametrize(
    ("stamp_s", "rate", "force", "code"),
    [
        (1.01, [0, 0, 36.0], [0, 0, 9.8], OUT_OF_RANGE),
        (1.01, [0, 0, 0], [0, -161.0, 9.8], OUT_OF_RANGE),
        (6.1, [0, 0, 0], [0, 0, 9.8], GAP),
        (0.9, [0, 0, 0], [0, 0, 9.8], GAP),
    ],
)
def test_an_invalid_sample_changes_nothing(propagator, stamp_s, rate, force, code) -> None:
    propagator.take(packed(some_state(np.random.default_rng(7)), np.eye(15)))
    before = propagator.state("")
    assert (
        propagator.step(stamp_s, np.array(rate, dtype=float), np.array(force, dtype=float)) == code
    )
    np.testing.assert_array_equal(propagator.state("").T_map_cabin, before.T_map_cabin)
    assert propagator.samples == 0


def test_an_estimate_that_is_not_finite_is_ignored(propagator) -> None:
    state = some_state(np.random.default_rng(8))
    propagator.take(packed(state, np.eye(15)))
    before = propagator.state("").T_map_cabin
    assert not propagator.take(packed(state, np.full((15, 15), np.nan)))
    np.testing.assert_array_equal(propagator.state("").T_map_cabin, before)


def test_states_are_immutable_and_can_be_pickled(propagator) -> None:
    rng = np.random.default_rng(9)
    propagator.take(packed(some_state(rng), np.eye(15)))
    kept, copies = [], []
    for sample in some_samples(rng, 100):
        go(propagator, [sample])
        kept.append(propagator.state("GLOBAL"))
        copies.append(kept[-1].T_map_base.copy())
    for state, copy in zip(kept, copies, strict=True):
        np.testing.assert_array_equal(state.T_map_base, copy)
    assert isinstance(kept[0], BaseState)
    assert kept[0].is_ready
    with pytest.raises(ValueError, match="read-only"):
        kept[0].covariance[0, 0] = 1.0
    with pytest.raises(AttributeError):
        kept[0].T_map_base = np.eye(4)
    sent = pickle.loads(pickle.dumps(kept[5]))
    for name in (
        "T_map_base",
        "T_odom_base",
        "T_map_cabin",
        "v_map_cabin",
        "w_map_cabin_in_cabin",
        "covariance",
    ):
        np.testing.assert_array_equal(getattr(sent, name), getattr(kept[5], name))
    assert (sent.stamp_s, sent.status) == (kept[5].stamp_s, kept[5].status)


def test_rows_for_reports_are_made_ahead_and_no_more_than_needed(propagator, turn) -> None:
    """A sample allocates nothing between two samples of the turn joint, which are as frequent."""
    propagator.take(packed(some_state(np.random.default_rng(2)), 1e-4 * np.eye(15)))
    for k in range(200):
        propagator.set_turn()
        assert 16 <= len(propagator._rows) < 48
        go(propagator, [Inertial(1.0 + (3 * k + n) / 1000, *np.zeros((2, 3))) for n in (1, 2, 3)])
