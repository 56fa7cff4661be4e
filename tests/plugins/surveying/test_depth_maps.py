"""The planes of a sweep: as near to each other as half a pixel asks for, and no nearer."""

import numpy as np
import pytest
from executive_plugins.surveying.depth_maps import sweep_planes
from executive_plugins.surveying.settings import DepthSettings

STEP_PIXELS = 1.25


def site(height_m: float) -> np.ndarray:
    """Return level ground, and four points at a height."""
    xy = np.random.default_rng(0).uniform(-3, 3, (200, 2))
    ground = np.column_stack([xy, np.zeros(200)])
    ground[:4, 2] = height_m
    return ground


@pytest.mark.parametrize("steps", [10, 25, 40])
def test_planes_are_a_step_apart_and_reach_both_ends(steps: int) -> None:
    settings = DepthSettings(pixel_m=0.02, below_m=0.25, above_m=0.5)
    step_m = STEP_PIXELS * settings.pixel_m
    height_m = steps * step_m - settings.below_m - settings.above_m
    planes = sweep_planes(site(max(height_m, 0.0)), np.array([[0.0, 0.0, 8.0]]), settings)
    ends = planes.offsets_m[[0, -1]]
    assert ends == pytest.approx([-settings.below_m, max(height_m, 0.0) + settings.above_m])
    apart_m = np.diff(planes.offsets_m)
    intervals = np.ceil(np.ptp(ends) / step_m - 1e-9)
    assert apart_m.max() <= step_m * (1 + 1e-9)
    assert len(apart_m) in (intervals, intervals + 1)  # rounding may ask for one more


def test_a_plane_count_is_bounded() -> None:
    few = sweep_planes(site(0.0), np.array([[0.0, 0, 8]]), DepthSettings(pixel_m=1.0))
    many = sweep_planes(site(5.0), np.array([[0.0, 0, 8]]), DepthSettings(pixel_m=0.002))
    assert (len(few.offsets_m), len(many.offsets_m)) == (8, 250)
