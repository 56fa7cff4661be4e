"""The least-squares problem of a recording, on a known motion without noise."""

from collections.abc import Sequence
from dataclasses import replace

import gtsam
import numpy as np
import pytest
from executive_plugins.estimation.calibration.keyframe_problem import (
    KeyframeProblem,
    Receiver,
    Solved,
    Unknowns,
    walking,
)
from executive_plugins.estimation.factors import insert, keys
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState, propagate

NOISE = InertialNoise(1e-4, 1e-3, 1e-5, 1e-4, 0.1, 9.81, 0.01)
DT_S = 0.02
ARMS = {"left": np.array([0.5, 1.0, 2.0]), "right": np.array([0.4, -1.1, 2.1])}
LATE_S, STD_M = 0.034, 0.01
FIXED_S = [round(0.6 + 0.3 * k, 6) for k in range(24)]


def motion() -> tuple[list[InertialState], SampleBuffer]:
    """Integrate made-up samples from rest: turns about all axes, starts and halts."""
    samples = SampleBuffer()
    first = Inertial(0.0, np.zeros(3), np.array([0.0, 0.0, 9.81]), 0.0)
    samples.append(first)
    zero = np.zeros(3)
    states = [InertialState(first, np.eye(3), zero, zero, zero, zero)]
    for k in range(1, 420):
        t = k * DT_S
        rate = np.array([0.5 * np.cos(2.1 * t), 0.6 * np.cos(1.7 * t), 0.9 * np.cos(1.1 * t)])
        pull = np.array([2.0 * np.cos(2.3 * t), 1.5 * np.sin(1.9 * t), 0.3 * np.cos(3.0 * t)])
        force = states[-1].R_map_imu.T @ (pull + [0.0, 0.0, 9.81])
        samples.append(Inertial(t, rate, force, DT_S))
        states.append(propagate(states[-1], Inertial(t, rate, force, DT_S), 9.81))
    return states, samples


STATES, SAMPLES = motion()


def fixes(noise_m: float = 0.0, late_s: float = LATE_S) -> list[Fix]:
    """Return fixes of both antennas whose stamps are later than their times of measurement."""
    rng, found = np.random.default_rng(3), []
    stamps = np.array([state.stamp_s for state in STATES])
    for at_s in FIXED_S:
        before = STATES[int(np.searchsorted(stamps, at_s, side="right")) - 1]
        state = before
        if at_s > before.stamp_s:
            state = propagate(before, SAMPLES.at(at_s), 9.81)
        for name, arm in ARMS.items():
            p = state.p_map_imu + state.R_map_imu @ arm + rng.normal(0, 1, 3) * noise_m
            found.append(Fix(round(at_s + late_s, 6), name, arm, p, STD_M**2 * np.eye(3)))
    return found


def unknowns(scale: float = 1.0, late_s: float = 0.0) -> Unknowns:
    declared = {name: arm + [0.1, -0.05, 0.08] for name, arm in ARMS.items()}
    receivers = (Receiver(("left", "right"), late_s, scale),)
    return Unknowns(declared, declared, receivers, 0.3, 0.15)


def problem(
    given: Sequence[Fix], among: Unknowns, guesses: Sequence[InertialState] = STATES[::10]
) -> KeyframeProblem:
    return KeyframeProblem(given, guesses, SAMPLES, NOISE, among)


def solved(given: Sequence[Fix], among: Unknowns) -> Solved:
    found = problem(given, among).solved()
    assert found is not None
    return found


def test_clocks_and_arms_are_found_within_rounds() -> None:
    first = solved(fixes(), unknowns())
    (receiver,) = first.unknowns.receivers
    assert receiver.antennas == ("left", "right")
    assert first.moved_s == abs(receiver.late_s) > 0.02
    assert receiver.late_s == pytest.approx(LATE_S, abs=0.01)  # the motion is taken as straight
    found = solved(fixes(), solved(fixes(), first.unknowns).unknowns)
    assert found.unknowns.receivers[0].late_s == pytest.approx(LATE_S, abs=2e-4)
    assert found.moved_s < 2e-4
    for name, arm in ARMS.items():
        assert found.unknowns.arms_imu[name] == pytest.approx(arm, abs=2e-3)
        assert found.unknowns.declared_imu[name] == pytest.approx(arm + [0.1, -0.05, 0.08])
    stamps = np.array([state.stamp_s for state in found.states])
    assert stamps == pytest.approx(np.array(FIXED_S), abs=5e-4)
    truth = {state.stamp_s: state for state in STATES}
    nearest = truth[min(truth, key=lambda t: abs(t - stamps[12]))]
    assert found.states[12].p_map_imu == pytest.approx(nearest.p_map_imu, abs=0.05)


def test_what_was_declared_holds_unless_the_fixes_say_otherwise() -> None:
    """Fixes as uncertain as ten metres leave the arms and the clock where they were declared."""
    vague = [replace(one, covariance=100.0 * np.eye(3)) for one in fixes()[:12]]
    among = unknowns()
    nearer = {name: arm + 0.5 for name, arm in ARMS.items()}
    found = solved(vague, replace(among, arms_imu=nearer))  # the guess of a round before
    for name in ARMS:
        assert found.unknowns.arms_imu[name] == pytest.approx(among.declared_imu[name], abs=0.02)
    assert found.unknowns.receivers[0].late_s == pytest.approx(0.0, abs=0.005)
    late = solved(vague, unknowns(late_s=0.03))  # the declared clock is 0 in each round
    assert late.unknowns.receivers[0].late_s == pytest.approx(0.0, abs=0.005)
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx([0.3] * 6 + [0.15], rel=0.1)


def test_the_misfit_is_one_if_the_noise_is_as_declared() -> None:
    """Of 144 residuals, 15 are left for the motion; the kernel takes little off."""
    among = solved(fixes(), unknowns()).unknowns
    given = fixes(noise_m=STD_M)
    found = solved(given, among)
    assert found.free == 3 * len(given) - 15
    assert found.misfit == pytest.approx(1.0, abs=0.25)
    scaled = replace(among, receivers=tuple(replace(one, scale=4.0) for one in among.receivers))
    assert solved(given, scaled).misfit == pytest.approx(found.misfit / 4.0, rel=0.15)


def test_the_covariance_is_that_of_the_whole_problem() -> None:
    """Against the inverse of all information at the solution, with every key kept."""
    among = solved(fixes(), unknowns()).unknowns
    whole = problem(fixes(STD_M), among)
    found = whole.solved()
    assert found is not None
    values = gtsam.Values()
    for i, state in enumerate(found.states):
        insert(values, i, state)
    for i, arm in enumerate(found.unknowns.arms_imu.values()):
        values.insert(gtsam.symbol("l", i), arm)
    move_s = found.unknowns.receivers[0].late_s - among.receivers[0].late_s
    values.insert(gtsam.symbol("d", 0), np.array([move_s]))
    ordering, starts, size = gtsam.Ordering(), {}, 0
    sizes = {key: n for i in range(24) for key, n in zip(keys(i), (6, 3, 6), strict=True)}
    sizes |= {gtsam.symbol("l", 0): 3, gtsam.symbol("l", 1): 3, gtsam.symbol("d", 0): 1}
    for key, n in sizes.items():
        ordering.push_back(key)
        starts[key], size = size, size + n
    A, _ = whole._graph.linearize(values).jacobian(ordering)
    root = np.linalg.inv(np.linalg.qr(A, mode="r"))
    P = root @ root.T
    middle = starts[keys(12)[0]]
    assert found.attitude == pytest.approx(P[middle : middle + 3, middle : middle + 3], rel=1e-3)
    assert found.covariance == pytest.approx(P[-7:, -7:], rel=1e-3, abs=1e-9)


def test_fixes_outside_the_motion_that_is_known_are_left_out() -> None:
    guesses = [state for state in STATES if 1.0 <= state.stamp_s <= 5.0]
    found = problem(fixes(late_s=0.0), unknowns(), guesses).solved()
    assert found is not None
    stamps = [state.stamp_s for state in found.states]
    assert stamps == [t for t in FIXED_S if 1.0 <= t <= 5.0]
    assert found.free == 6 * len(stamps) - 15
    at_the_ends = problem(fixes(late_s=0.0), unknowns(), [*guesses[10:], STATES[-1]]).solved()
    assert at_the_ends is not None  # the first guess is at 1.2 s, exactly that of a fix
    assert at_the_ends.states[0].stamp_s == 1.2


def test_too_few_fixes_leave_the_motion_open() -> None:
    """A state has 15 unknowns: 30 residuals are the least, of ten fixes."""
    enough = problem(fixes()[:10], unknowns()).solved()
    assert enough is not None
    assert enough.free == 15
    assert problem(fixes()[:9], unknowns()).solved() is None


def test_biases_walk_fast_enough_to_be_solved_for() -> None:
    slow = replace(NOISE, gyro_bias_walk=1e-7, accel_bias_walk=1e-6)
    assert walking(slow) == replace(NOISE, gyro_bias_walk=1e-5, accel_bias_walk=1e-4)
    fast = replace(NOISE, gyro_bias_walk=1e-3, accel_bias_walk=1e-2)
    assert walking(fast) == fast
