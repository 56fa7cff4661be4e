"""The rotation that levels a force, and what becomes of a graph that has no solution."""

import gtsam
import numpy as np
import pytest
from executive_plugins.estimation.start.window_solution import levelled, solved

UP = np.array([0.0, 0.0, 1.0])
KEY = 0


@pytest.mark.parametrize("force", [[0.0, 0.0, 9.81], [0.0, 0.0, -9.81], [1.0, -2.0, 9.0]])
def test_a_levelled_force_points_upwards(force: list[float]) -> None:
    R = levelled(np.array(force))
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(R @ force, np.linalg.norm(force) * UP, atol=1e-9)


def test_a_force_that_points_upwards_is_not_turned() -> None:
    np.testing.assert_array_equal(levelled(9.81 * UP), np.eye(3))


def test_the_smallest_rotation_turns_about_a_level_axis_by_the_angle_to_the_vertical() -> None:
    tilt_rad = 0.3
    R = levelled(np.array([0.0, -np.sin(tilt_rad), np.cos(tilt_rad)]))
    c, s = np.cos(tilt_rad), np.sin(tilt_rad)
    np.testing.assert_allclose(R, [[1, 0, 0], [0, c, s], [0, -s, c]], atol=1e-12)


def at(*places: float) -> gtsam.NonlinearFactorGraph:
    """Return a graph of one point that was measured at places on a line, each to 1 m."""
    graph, noise = gtsam.NonlinearFactorGraph(), gtsam.noiseModel.Isotropic.Sigma(1, 1.0)
    for place in places:
        graph.push_back(gtsam.PriorFactorVector(KEY, np.array([place]), noise))
    return graph


def guess(place: float) -> gtsam.Values:
    values = gtsam.Values()
    values.insert(KEY, np.array([place]))
    return values


def test_a_solution_is_the_mean_of_measurements_and_costs_half_their_squared_misfits() -> None:
    found = solved(at(1.0, 5.0), guess(0.0))
    assert found is not None
    np.testing.assert_allclose(found.values.atVector(KEY), [3.0], atol=1e-4)
    assert found.cost == pytest.approx(0.5 * (2.0**2 + 2.0**2))


def test_a_value_that_is_not_a_number_has_no_solution() -> None:
    assert solved(at(np.nan), guess(0.0)) is None


def test_a_factor_on_a_state_without_a_guess_has_no_solution() -> None:
    assert solved(at(1.0), gtsam.Values()) is None
