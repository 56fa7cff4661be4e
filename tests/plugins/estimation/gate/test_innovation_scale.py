"""The factor on a sensor's declared covariance by its innovations."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.innovation_scale import LARGEST_SCALE, InnovationScale

DECLARED = np.diag([0.01, 0.01, 0.02]) ** 2
PREDICTED = np.array([[4e-4, 1e-4, 0.0], [1e-4, 2e-4, 0.0], [0.0, 0.0, 1e-4]])


def factors(true: float, predicted: np.ndarray, draws: int = 20) -> np.ndarray:
    """Return the factors after 21 innovations each, of a sensor that errs by a factor."""
    rng, found = np.random.default_rng(1), []
    root = np.linalg.cholesky(predicted + true * DECLARED)
    for _ in range(draws):
        scale = InnovationScale(3)
        for innovation in rng.normal(size=(21, 3)) @ root.T:
            scale.add(innovation, predicted, DECLARED)
        found.append(scale.factor())
    return np.array(found)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("true", [4.0, 16.0])
def test_the_error_of_the_prediction_is_not_taken_for_the_sensors(
    share: float, true: float
) -> None:
    assert np.median(factors(true, share * PREDICTED)) == pytest.approx(true, rel=0.2)


def test_a_sensor_that_errs_less_than_it_declares_is_not_trusted_more() -> None:
    assert np.median(factors(0.2, PREDICTED)) == 1.0


def test_an_innovation_of_median_size_has_the_factor_that_makes_it_so() -> None:
    innovation, scale = np.array([0.04, -0.02, 0.05]), InnovationScale(3)
    for _ in range(5):
        assert scale.factor() == 1.0
        scale.add(innovation, PREDICTED, DECLARED)
    S = PREDICTED + scale.factor() * DECLARED
    assert innovation @ np.linalg.solve(S, innovation) == pytest.approx(2.366, rel=0.02)


def test_the_factor_is_bounded_and_few_outliers_do_not_count() -> None:
    scale = InnovationScale(3)
    for _ in range(11):
        scale.add(np.zeros(3), PREDICTED, DECLARED)
    for _ in range(10):
        scale.add(np.full(3, 100.0), PREDICTED, DECLARED)
    assert scale.factor() == 1.0
    scale.add(np.full(3, 100.0), PREDICTED, DECLARED)
    assert scale.factor() == LARGEST_SCALE


def test_a_known_factor_is_replaced_one_by_one_and_unknown_values_are_left_out() -> None:
    scale = InnovationScale(3, 9.0)
    for _ in range(10):
        scale.add(np.zeros(3), PREDICTED, DECLARED)
        scale.add(np.full(3, np.nan), PREDICTED, DECLARED)
    assert scale.factor() == 9.0
    scale.add(np.zeros(3), PREDICTED, DECLARED)
    assert scale.factor() == 1.0


def test_a_covariance_that_leaves_directions_out_explains_the_others() -> None:
    scale, flat = InnovationScale(3), np.diag([1e-4, 1e-4, 0.0])
    for _ in range(5):
        scale.add(np.array([0.03, 0.04, 0.0]), 1e-4 * np.eye(3), flat)
    found = 25e-4 / (1e-4 + scale.factor() * 1e-4)
    assert found == pytest.approx(2.366, rel=0.02)
    for _ in range(21):
        scale.add(np.array([0.0, 0.0, 0.04]), 1e-4 * np.eye(3), flat)
    assert scale.factor() == LARGEST_SCALE


def test_a_covariance_that_is_none_says_nothing() -> None:
    scale = InnovationScale(3, 4.0)
    for _ in range(21):
        scale.add(np.ones(3), np.zeros((3, 3)), np.diag([1.0, -1.0, 1.0]))
    assert scale.factor() == 4.0


@pytest.mark.parametrize("known", [1.0, 1.5, 2.0])
def test_a_known_factor_holds_from_the_first_innovation_on(known: float) -> None:
    scale = InnovationScale(3, known)
    assert scale.factor() == known
    for _ in range(10):  # the eleventh of 21 would be the median
        scale.add(np.full(3, 100.0), PREDICTED, DECLARED)
    assert scale.factor() == (known if known > 1.0 else LARGEST_SCALE)
