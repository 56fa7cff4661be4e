"""First guesses of a window: whatever the heading, they put the antennas where the fixes are."""

import numpy as np
import pytest
from executive_plugins.estimation.factors import keys
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.start.window_problem import (
    CLOCK,
    Knowledge,
    WindowProblem,
    misfit,
)
from scipy.stats import chi2

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
    error = problem(heading_rad).graph().error(values)
    assert error == pytest.approx(heading_rad**2 / 200, abs=2e-4)


def test_a_clock_that_is_not_known_is_part_of_the_solution() -> None:
    known, unknown = problem(0.3).solved(0.3), problem(0.3, clock_std_s=0.01).solved(0.3)
    assert known is not None
    assert not known.values.exists(CLOCK)
    assert unknown is not None
    assert unknown.values.atVector(CLOCK) == pytest.approx([0.0], abs=1e-3)


@pytest.mark.parametrize("turn_rad", [0.5, -2.0])
def test_with_any_heading_the_middle_of_the_antennas_stays_at_the_fixes(turn_rad: float) -> None:
    found = problem(1.0)
    middle = np.mean(list(ARMS.values()), axis=0)
    right = found.guess(1.0)
    for values in (found.guess(1.0 + turn_rad), found.turned(right, turn_rad)):
        for i in range(len(STAMPS_S)):
            T, truth = (each.atPose3(keys(i)[0]).matrix() for each in (values, right))
            np.testing.assert_allclose(
                T[:3, :3], from_rpy(0, 0, turn_rad) @ truth[:3, :3], atol=1e-9
            )
            np.testing.assert_allclose(
                T[:3, :3] @ middle + T[:3, 3], truth[:3, :3] @ middle + truth[:3, 3], atol=1e-9
            )


@pytest.mark.parametrize("clock_std_s", [0.0, 0.01])
def test_the_degrees_of_freedom_are_what_the_residuals_show(clock_std_s: float) -> None:
    """Expected squares of the fixes' residuals, by the projection that leaves them."""
    window = problem(0.3, clock_std_s)
    solution = window.solved(0.3)
    assert solution is not None
    A, _ = solution.graph.linearize(solution.values).jacobian(window.ordering())
    left = 1.0 - np.diag(A @ np.linalg.pinv(A, rcond=1e-14))
    # For each node both fixes; then the samples up to the next.
    rows = [21 * node + row for node in range(4) for row in range(6)]
    assert window.free(A, np.linalg.qr(A, mode="r")) == pytest.approx(left[rows].sum(), rel=1e-3)


def squares_of(scale: float, count: int) -> np.ndarray:
    """Return squared distances of fixes whose variance is larger by a factor."""
    return scale * np.random.default_rng(7).chisquare(3, count)


def test_the_misfit_of_many_fixes_is_the_factor_on_their_variance() -> None:
    squares = squares_of(4.0, 4000)
    assert misfit(squares, 12000.0, 16) == pytest.approx(4.0, rel=0.1)
    assert misfit(squares, 6000.0, 16) == pytest.approx(8.0, rel=0.1)  # half are determined


def test_few_fixes_tell_of_a_large_misfit_only() -> None:
    few = np.array([2.0, 3.0, 4.0, 5.0])
    assert misfit(few, 6.0, 16) == 1.0  # 14 are usual for six degrees of freedom
    assert misfit(5 * few, 6.0, 16) == pytest.approx(5 * 3.5 / chi2.median(3) * 2)
    assert misfit(5 * few, 1.0, 16) == 1.0  # all is determined by the fixes
    assert misfit(few, 6.0, 6) == pytest.approx(3.5 / chi2.median(3) * 2)


@pytest.mark.parametrize("is_late_s", [-0.1, 0.1])
def test_a_car_that_accelerates_tells_the_clock(is_late_s: float) -> None:
    rng, samples, arm = np.random.default_rng(5), SampleBuffer(), ARMS["left"]
    noise, swing = InertialNoise(1e-4, 0.03, 1e-6, 1e-5, 1e-2, 9.81, 0.01), np.pi
    for k in range(1401):
        force = [2.0 * np.sin(swing * (k - 0.5) / 100), 0.0, 9.81] + rng.normal(0.0, 0.3, 3)
        samples.append(Inertial(k / 100, rng.normal(0.0, 1e-3, 3), np.array(force), 0.01))
    nodes = []
    for stamp_s in np.linspace(1.0, 13.0, 30):
        t = stamp_s - is_late_s
        along = 5.0 * t - 2.0 * (np.sin(swing * t) / swing - t) / swing
        p_map = np.array([along, 0.0, 0.0]) + arm + rng.normal(0.0, 0.006, 3)
        nodes.append((stamp_s, [Fix(stamp_s, "left", arm, p_map, 3.6e-5 * np.eye(3))]))
    known = Knowledge(np.zeros(3), 1e-3, np.zeros(3), 0.0, 0.1)
    found = WindowProblem(nodes, samples, noise, known).solved(0.0)
    assert found is not None
    assert found.values.atVector(CLOCK) == pytest.approx([is_late_s], abs=0.03)
