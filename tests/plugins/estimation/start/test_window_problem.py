"""First guesses of a window: whatever the heading, they put the antennas where the fixes are."""

import numpy as np
import pytest
from executive_plugins.estimation.factors import keys
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.start.window_problem import CLOCK, Knowledge, WindowProblem

from executive.geometry.rotation import exp_so3, from_rpy

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
TILT = exp_so3(np.array([0.1, -0.05, 0.0]))  # about a level axis, as gravity alone tells it
ARMS = {"left": np.array([1.0, 2.0, 0.5]), "right": np.array([1.0, -2.0, 0.3])}
SPEED = np.array([0.4, -0.2, 0.0])
STAMPS_S = (0.0, 0.5, 1.0, 1.5)


def problem(heading_rad: float, clock_std_s: float = 0.0) -> WindowProblem:
    """A tilted body that moves evenly without turning, with two antennas."""
    R, z = from_rpy(0.0, 0.0, heading_rad) @ TILT, np.zeros(3)
    samples = SampleBuffer()
    for k in range(201):
        samples.append(Inertial(k / 100, z, TILT.T @ [0.0, 0.0, 9.81], 0.01))
    nodes = [
        (
            at_s,
            [
                Fix(at_s, name, arm, at_s * SPEED + R @ arm, 1e-4 * np.eye(3))
                for name, arm in ARMS.items()
            ],
        )
        for at_s in STAMPS_S
    ]
    known = Knowledge(z, 1e-3, z, 0.0, clock_std_s)
    return WindowProblem(nodes, samples, NOISE, known)


@pytest.mark.parametrize("heading_rad", [0.0, 1.0, -2.5])
def test_with_the_right_heading_the_guess_is_the_motion(heading_rad: float) -> None:
    values = problem(heading_rad).guess(heading_rad)
    for i, at_s in enumerate(STAMPS_S):
        x, v, _ = keys(i)
        T = values.atPose3(x).matrix()
        np.testing.assert_allclose(T[:3, :3], from_rpy(0, 0, heading_rad) @ TILT, atol=1e-9)
        np.testing.assert_allclose(T[:3, 3], at_s * SPEED, atol=1e-9)
        np.testing.assert_allclose(values.atVector(v), SPEED, atol=1e-9)
    assert not values.exists(CLOCK)
    # All fits; the weak priors of heading and speed are what is left.
    error = problem(heading_rad).graph.error(values)
    assert error == pytest.approx(heading_rad**2 / 200, abs=2e-4)


def test_a_clock_that_is_not_known_is_guessed_as_right() -> None:
    values = problem(0.3, clock_std_s=0.01).guess(0.3)
    assert values.atVector(CLOCK) == pytest.approx([0.0])


@pytest.mark.parametrize("turn_rad", [0.5, -2.0])
def test_with_any_heading_the_middle_of_the_antennas_stays_at_the_fixes(turn_rad: float) -> None:
    found = problem(1.0)
    middle = np.mean(list(ARMS.values()), axis=0)
    right = found.guess(1.0)
    for values in (found.guess(1.0 + turn_rad), found.held(right, turn_rad)[1]):
        for i in range(len(STAMPS_S)):
            T, truth = (each.atPose3(keys(i)[0]).matrix() for each in (values, right))
            np.testing.assert_allclose(
                T[:3, :3], from_rpy(0, 0, turn_rad) @ truth[:3, :3], atol=1e-9
            )
            np.testing.assert_allclose(
                T[:3, :3] @ middle + T[:3, 3], truth[:3, :3] @ middle + truth[:3, 3], atol=1e-9
            )
