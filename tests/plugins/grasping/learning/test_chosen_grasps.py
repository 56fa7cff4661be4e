"""Which stones and which grasps are labelled."""

from collections import Counter

import numpy as np
import pytest
from executive_plugins.grasping.classifier import outcome_net
from executive_plugins.grasping.learning import labels
from executive_plugins.grasping.learning.labels import (
    LabelSettings,
    chosen_for_lifts,
    network_first,
    resting_stone,
)
from executive_plugins.grasping.sampling.pool import Pool

from executive.arrays import Float
from executive.geometry.pose import pose


def pool(count: int) -> Pool:
    """Return grasps of which a later one is the nearer."""
    costs = {name: np.zeros(count) for name in ("align_rad", "enclose_m")}
    costs["distance_m"] = np.arange(count, 0, -1.0)
    shapes = np.zeros((count, 3, 3)), np.zeros((count, 3)), np.zeros(count)
    return Pool(*shapes, costs, Counter(), np.zeros(count, dtype=int))


def test_half_of_the_grasps_are_the_first_of_the_paper_and_half_are_random() -> None:
    drawn = [chosen_for_lifts(pool(12), 5, np.random.default_rng(k)).tolist() for k in range(20)]
    assert all(one[:2] == [11, 10] for one in drawn)
    assert all(len(set(one)) == 5 for one in drawn)
    assert {index for one in drawn for index in one[2:]} == set(range(10))


def test_with_a_network_a_third_each_are_its_first_the_papers_first_and_random() -> None:
    likely = np.array([4, 11])
    drawn = [
        chosen_for_lifts(pool(12), 6, np.random.default_rng(k), likely).tolist() for k in range(60)
    ]
    assert all(one[:4] == [4, 11, 10, 9] for one in drawn)
    assert all(len(set(one)) == 6 for one in drawn)
    for place in (4, 5):  # none of these is always the same
        assert {one[place] for one in drawn} == {0, 1, 2, 3, 5, 6, 7, 8}


def test_a_network_chooses_as_a_planner_tries_what_differs_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of four grasps the two likeliest are one place; the planner tries the third before them."""
    place = np.array([[0.0, 0, 0], [0.01, 0, 0], [0.5, 0, 0], [1.0, 0, 0]])
    turns = np.repeat(np.eye(3)[None], 4, axis=0)
    never = np.zeros(4, dtype=int)
    grasps = Pool(turns, place, np.zeros(4), {"distance_m": np.zeros(4)}, Counter(), never)
    likely = np.array([0.9, 0.8, 0.5, 0.7])
    monkeypatch.setattr(labels, "_net_of", lambda weights: weights)
    monkeypatch.setattr(labels, "features_of", lambda scene, taken, gripper: len(taken))
    monkeypatch.setattr(outcome_net, "success", lambda net, shown: likely if shown == 4 else None)
    chosen = network_first("mine", None, grasps, None, 3)
    assert chosen.tolist() == [0, 3, 2]
    assert network_first("mine", None, grasps, None, 9).tolist() == [0, 3, 2, 1]
    assert network_first("", None, grasps, None, 3).tolist() == []


@pytest.mark.parametrize("count", [0, 1, 3])
def test_of_few_grasps_all_are_chosen(count: int) -> None:
    chosen = chosen_for_lifts(pool(count), 8, np.random.default_rng(0))
    assert sorted(chosen.tolist()) == list(range(count))


def test_stones_are_drawn_until_one_rests_with_its_middle_above_the_origin(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    volumes, made = list[float](), list[str]()
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 1]])

    def maker(name: str) -> object:
        def make(volume_m3: float, rng: np.random.Generator) -> Float:
            volumes.append(volume_m3)
            made.append(name)
            return corners

        return make

    rests = iter([None, None] + [pose(t=np.array([5.0, 6.0, 7.0]))] * 300)
    monkeypatch.setattr(labels, "rounded_stone", maker("rounded"))
    monkeypatch.setattr(labels, "block", maker("block"))
    monkeypatch.setattr(labels, "at_rest", lambda hull, rng: next(rests))
    settings, rng = LabelSettings(rounded=0.25, volume_m3=(0.125, 1.0)), np.random.default_rng(1)
    found = resting_stone(settings, rng)
    assert len(made) == 3
    np.testing.assert_allclose(found, corners + [-1.0, -0.5, 7.0])
    for _ in range(297):
        resting_stone(settings, rng)
    assert made.count("rounded") / 300 == pytest.approx(0.25, abs=0.08)  # three deviations
    edges = np.cbrt(volumes)
    assert edges.min() > 0.5
    assert edges.max() < 1.0
    assert edges.mean() == pytest.approx(0.75, abs=0.025)  # three deviations
