"""The terms of the score: each from its least value to its best, between what is worst and best."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.parts import Places
from executive_plugins.placing.dry_stone.settings import ScorerSettings
from executive_plugins.placing.dry_stone.weighted import Weighted

NAMES = (
    "contact_share",
    "mean_gap_m",
    "support_margin_m",
    "largest_support_share",
    "outside_share",
    "depth_m",
    "top_m",
    "beside_share",
    "void_m3",
    "bottom_m",
    "top_gap_m",
    "joints_closed",
    "along_m",
    "before_m",
    "after_m",
)
WORST = dict(zip(NAMES, (0.0, 0.2, 0.0, 1.0, 0.0, 0.3, 1.5, 0.0, 0.4, 1.5, 0.3, -1.0, 2.0,
                             0.325, 0.325), strict=True))  # fmt: skip
BEST = dict(zip(NAMES, (1.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0,
                            0.0, 0.0), strict=True))  # fmt: skip
BEYOND = {"bottom_m": -0.01, "support_margin_m": 9.0, "depth_m": -1.0}
FIRST = {"volume": [0.5, 0.5, 0.5], "void": [-1.0, -0.5, 0.0], "joints": [-1.0, 0.0, 1.0],
         "gaps": [-1.0, -0.5, 0.0]}  # fmt: skip


def scored(*rows: dict[str, float]) -> dict[str, np.ndarray]:
    """Return the terms without their weights of a stone half as large as the largest."""
    measured = {name: np.array([row[name] for row in rows]) for name in NAMES}
    stones = [SimpleNamespace(volume_m3=volume, extents_m=(length_m, 0.5, 0.3))
              for volume, length_m in ((0.2, 1.0), (0.4, 1.5), (0.1, 2.0))]  # fmt: skip
    places = Places(stones[0], np.eye(3), np.zeros((len(rows), 3)), measured)
    built = SimpleNamespace(structure=SimpleNamespace(height_m=1.5))
    settings = ScorerSettings()
    terms = Weighted(settings).score(places, built, stones)
    weights = settings.weights.model_dump()
    assert set(terms) == set(weights)
    return {name: value / weights[name] for name, value in terms.items() if weights[name]}


def test_terms_run_from_the_worst_to_the_best() -> None:
    middle = {name: (WORST[name] + BEST[name]) / 2 for name in NAMES}
    for name, value in scored(WORST, middle, BEST).items():
        assert value == pytest.approx(FIRST.get(name, [0.0, 0.5, 1.0])), name


def test_what_is_beyond_the_best_or_worst_counts_no_more() -> None:
    found = scored(WORST | BEYOND)
    assert found["height"] == pytest.approx([1.0])  # a foot that has sunk into the ground
    assert found["margin"] == pytest.approx([1.0])
    assert found["face"] == pytest.approx([1.0])


def test_no_support_is_no_worse_than_the_edge_of_it() -> None:
    """A stone that is to tilt to rest has its centre of mass beside what it first touches."""
    assert scored(WORST | {"support_margin_m": -0.3})["margin"] == pytest.approx([0.0])


def test_a_gap_costs_what_it_is_long_by_the_share_of_stones_that_it_is_too_short_for() -> None:
    """The stones need 0.65 m each: 0.5 m, and 7.5 cm to either side."""
    left_m = (0.64, 0.0), (0.66, 0.0), (np.inf, 2.0), (0.64, 0.64)
    found = scored(*(WORST | {"before_m": one, "after_m": other} for one, other in left_m))
    assert found["gaps"] == pytest.approx([-0.64 / 0.65, 0.0, 0.0, -1.28 / 0.65])
