"""What is seen of a stone from below takes the place of what its model guessed there."""

import numpy as np
import pytest

from executive.leaf.underside import with_underside

HEIGHT_M = 0.8


def sides(foot_m: float = 0.0) -> np.ndarray:
    """Return the sides and the top of a block of 1 m × 1 m from a height up [m]."""
    along, up = np.arange(-0.5, 0.501, 0.05), np.arange(foot_m, HEIGHT_M, 0.05)
    a, z = np.stack(np.meshgrid(along, up), -1).reshape(-1, 2).T
    top = np.stack(np.meshgrid(along, along), -1).reshape(-1, 2)
    around = [np.column_stack([s * np.full_like(a, 0.5), a, z]) for s in (-1, 1)]
    around += [np.column_stack([a, s * np.full_like(a, 0.5), z]) for s in (-1, 1)]
    return np.concatenate([*around, np.column_stack([top, np.full(len(top), HEIGHT_M)])])


def keel(share: float = 1.0) -> np.ndarray:
    """Return returns from the underside of a block whose sides end 0.3 m above its keel, which runs
    along y; a share of its length is seen.
    """
    rng = np.random.default_rng(3)
    x = rng.uniform(-0.5, 0.5, 6000)
    y = rng.uniform(-0.5, -0.5 + share, 6000)
    return np.column_stack([x, y, 0.6 * np.abs(x)]) + rng.normal(0.0, 0.004, (6000, 3))


def test_a_foot_that_was_guessed_gives_way_to_what_is_seen_from_below() -> None:
    told = with_underside(sides(), keel())
    assert told.seen > 0.65  # the columns at its rim are seen in part
    # What is left of the sides begins where the underside ends, not on the ground.
    side = told.points[np.abs(told.points[:, 0]) > 0.49]
    assert side[:, 2].min() > 0.19
    middle = told.points[np.abs(told.points[:, 0]) < 0.03]
    assert middle[:, 2].min() == pytest.approx(0.0, abs=0.03)
    assert told.points[:, 2].max() == pytest.approx(HEIGHT_M)


def test_where_nothing_was_seen_the_model_stays() -> None:
    model = sides()
    told = with_underside(model, keel(share=0.3))
    assert 0.2 < told.seen < 0.5
    far = told.points[told.points[:, 1] > 0.2]
    np.testing.assert_array_equal(far, model[model[:, 1] > 0.2])


def test_a_view_of_nothing_changes_nothing() -> None:
    model = sides()
    beside = keel() + [3.0, 0.0, 0.0]
    for view in (np.empty((0, 3)), beside, keel()[:20]):
        told = with_underside(model, view)
        np.testing.assert_array_equal(told.points, model)
        assert (told.seen, told.raised_m) == (0.0, 0.0)


def test_a_stone_whose_lower_half_was_guessed_too_low_is_raised() -> None:
    flat = keel() * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.12]
    told = with_underside(sides(), flat + np.random.default_rng(1).normal(0, 0.005, flat.shape))
    assert told.raised_m == pytest.approx(0.12, abs=0.02)
