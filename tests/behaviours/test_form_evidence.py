"""Whether what the map shows is the known stone: by the heights of its patches above the model."""

import numpy as np
import pytest

from executive.leaf.form_evidence import FormSettings, form_evidence, form_refusal, is_refuted
from executive.messages.cloud import Cloud

REACH_M = 0.3
SURE = np.log(1e3)
NOISE_M = 0.015


def ellipsoid(axes, count=4000, seed=0):
    """Return points on an ellipsoid [m], shape (N, 3)."""
    directions = np.random.default_rng(seed).normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True) * axes


def noisy(points, seed=1):
    return points + np.random.default_rng(seed).normal(0.0, NOISE_M, points.shape)


@pytest.fixture(scope="module")
def model():
    return ellipsoid([0.5, 0.4, 0.35])


def view(points):
    """Return those points that a sensor at the side and above sees."""
    return points[points @ [0.6, 0.3, 0.74] > 0.0]


def test_a_noisy_view_of_the_stone_is_of_the_stone(model):
    found = form_evidence(noisy(view(ellipsoid([0.5, 0.4, 0.35], seed=2))), model, REACH_M)
    assert found.log_ratio > 2 * SURE
    assert found.alike > 0.98


def test_a_stone_of_the_same_volume_and_another_form_is_another_stone(model):
    found = form_evidence(noisy(view(ellipsoid([0.43, 0.43, 0.38], seed=2))), model, REACH_M)
    assert found.log_ratio < -SURE


def test_the_same_stone_off_its_place_is_not_there(model):
    found = form_evidence(noisy(view(model)) + [0.06, 0.0, 0.0], model, REACH_M)
    assert found.log_ratio < -SURE


def test_clutter_beside_the_stone_does_not_hide_it(model):
    seen = noisy(view(ellipsoid([0.5, 0.4, 0.35], seed=2)))
    twig = np.random.default_rng(3).uniform([0.62, -0.1, 0.1], [0.7, 0.1, 0.15], (150, 3))
    assert form_evidence(np.vstack([seen, twig]), model, REACH_M).log_ratio > SURE


def test_a_few_patches_are_not_enough_and_none_say_nothing(model):
    top = model[model[:, 2] > 0.33]
    assert 0.0 < form_evidence(top, model, REACH_M).log_ratio < SURE
    assert form_evidence(model + [5.0, 0.0, 0.0], model, REACH_M).log_ratio == 0.0


def refuted(points, model):
    return is_refuted(Cloud("map", points), model, FormSettings())


def test_what_lies_on_a_stone_does_not_refute_it_and_another_stone_in_its_place_does(model):
    seen = noisy(view(ellipsoid([0.5, 0.4, 0.35], seed=2)))
    beside = seen[seen[:, 1] > 0.2] * [1.0, 1.12, 1.12]  # a layer some 4 cm off a part of it
    both = np.vstack([seen, beside])
    assert form_evidence(both, model, REACH_M).log_ratio < -SURE  # of all that the map shows there
    assert not refuted(both, model)
    assert refuted(np.vstack([seen + [0.06, 0.0, 0.0], beside]), model)
    assert refuted(beside, model)
    assert refuted(noisy(view(ellipsoid([0.43, 0.43, 0.38], seed=2))), model)


def test_sides_that_nobody_had_seen_do_not_hide_a_stone_that_was_put_there(model):
    """Known from one side, and seen from the top and the sides next to it."""
    known, settings = model[model @ [0.9, -0.3, 0.3] > 0.05], FormSettings()
    seen = noisy(view(ellipsoid([0.5, 0.4, 0.35], seed=2)))
    assert "of what the map shows there" in form_refusal(Cloud("map", seen), known, settings)
    assert form_refusal(Cloud("map", seen), known, settings, is_expected=True) == ""
    moved = Cloud("map", seen + [0.06, 0.0, 0.0])
    assert "of its own surface" in form_refusal(moved, known, settings, is_expected=True)


def test_an_empty_place_refutes_a_stone_and_a_few_points_of_it_do_not(model):
    ground = np.column_stack(
        [np.random.default_rng(1).uniform(-1, 1, (500, 2)), np.full(500, -0.3)]
    )
    assert refuted(ground, model)
    assert refuted(np.empty((0, 3)), model)
    assert not refuted(np.vstack([ground, model[model[:, 2] > 0.33]]), model)
