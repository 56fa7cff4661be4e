"""Signs that a cloud is no site, each on a cloud that shows it and on one that just does not."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.segmentation.lower_cone import LowerCone, Relief
from executive_plugins.segmentation.site_check import (
    site_warnings,
    spacing_warnings,
    unit_warnings,
)

from executive.messages.segment import PartKind

LEVEL = np.array([0.0, 0.0, 1.0, 0.0])
FLAT = Relief(0.0, 0.0)


def told(points: np.ndarray, heights: np.ndarray | None = None, relief: Relief = FLAT) -> str:
    heights = points[:, 2] if heights is None else heights
    found = site_warnings(points, LEVEL, heights, relief, 0.1, np.random.default_rng(0))
    return "; ".join(found)


def ground(count: int = 1000, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-5, 5, (count, 3)) * [1, 1, 0.01]


def test_level_ground_is_a_site() -> None:
    assert told(ground()) == ""


@pytest.mark.parametrize(("wall", "speaks"), [(1100, False), (1700, True)])
def test_a_wall_with_more_points_than_the_ground_may_be_the_ground(wall, speaks) -> None:
    """A third more at least: of both, the share on the plane is told, and its tilt."""
    upright = np.roll(ground(wall, 1), 1, axis=1) + [7.0, 0.0, 6.0]
    text = told(np.vstack([ground(), upright]))
    assert ("is z up?" in text) is speaks
    if speaks:
        assert "a plane tilted by 90 deg" in text or "a plane tilted by 89 deg" in text


@pytest.mark.parametrize(
    ("relief", "speaks"),
    [
        (Relief(0.02, 0.01), True),
        (Relief(0.02, 0.02), False),
        (Relief(0.009, 0.0), False),
        (Relief(0.1, 0.3), False),
    ],
)
def test_ground_with_hollows_for_stones_hangs_from_the_sky(relief, speaks) -> None:
    assert ("is z down?" in told(ground(), relief=relief)) is speaks


@pytest.mark.parametrize(("share", "speaks"), [(0.24, True), (0.26, False)])
def test_a_site_has_ground(share: float, speaks: bool) -> None:
    heights = np.where(np.arange(1000) < 1000 * share, -0.05, -3.0)
    text = told(ground(), heights)
    assert ("of the points are ground: is this a site of stones?" in text) is speaks
    if speaks:
        assert "only 24%" in text


def test_points_far_apart_are_told_with_the_smallest_stone() -> None:
    assert spacing_warnings(0.05, 0.05, 0.3) == ()
    (text,) = spacing_warnings(0.06, 0.05, 0.3)
    assert text.startswith("points are 0.06 m apart: stones shorter than 0.30 m")


def large(*lengths_m: float, kind: PartKind = PartKind.TOO_LARGE) -> list:
    return [SimpleNamespace(kind=kind, extents=np.array([one, 1.0, 1.0])) for one in lengths_m]


def test_things_that_are_stones_in_feet_raise_the_question_of_the_unit() -> None:
    (text,) = unit_warnings(2, large(3.0, 4.0, 5.0), 2.0)
    assert text.startswith("3 things are too large for stones, 4.0 m long; in feet they would be 1")
    assert unit_warnings(2, large(3.0, 4.0, 5.0, kind=PartKind.STACK), 2.0)
    assert unit_warnings(2, large(3.0, 4.0), 2.0) == ()  # too few
    assert unit_warnings(3, large(3.0, 4.0, 5.0), 2.0) == ()  # more are stones in metres
    assert unit_warnings(2, large(3.0, 4.0, 7.0), 2.0) == ()  # one is no stone in feet either
    other = next(k for k in PartKind if k not in (PartKind.TOO_LARGE, PartKind.STACK))
    assert unit_warnings(0, large(3.0, 4.0, 5.0, kind=other), 2.0) == ()
    assert unit_warnings(0, (), 2.0) == ()


def test_what_stands_on_a_slope_is_no_ground_and_the_slope_is() -> None:
    x, y = (each.ravel() for each in np.meshgrid(np.arange(0, 6, 0.1), np.arange(0, 6, 0.1)))
    places = np.column_stack([x, y])
    slope = 0.3 * x - 0.2 * y
    block = (np.abs(x - 3) < 0.65) & (np.abs(y - 3) < 0.65)
    heights = slope + np.where(block, 0.9, 0.0)
    cone = LowerCone.under(places, heights, 0.2, 0.6)
    is_ground = cone.may_be_ground(heights, 0.15)
    assert is_ground[~block].mean() > 0.99
    middle = (np.abs(x - 3) < 0.4) & (np.abs(y - 3) < 0.4)
    assert not is_ground[middle].any()
    rising = cone.steep_share(0.15)
    assert rising == pytest.approx(block.mean(), rel=0.3)
    sinking = LowerCone.under(places, -heights, 0.2, 0.6).steep_share(0.15)
    assert sinking > 2 * rising  # the ground all around the block
    for bare in (slope, -slope):
        assert LowerCone.under(places, bare, 0.2, 0.6).steep_share(0.15) == 0.0


def test_a_single_reflection_below_the_ground_lowers_nothing() -> None:
    x, y = (each.ravel() for each in np.meshgrid(np.arange(0, 6, 0.1), np.arange(0, 6, 0.1)))
    heights = np.zeros(len(x))
    heights[1830] = -4.0
    cone = LowerCone.under(np.column_stack([x, y]), heights, 0.2, 0.6)
    is_ground = cone.may_be_ground(heights, 0.15)
    assert not is_ground[1830]
    assert np.delete(is_ground, 1830).all()
