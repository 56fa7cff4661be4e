"""The room around a place: gaps that noise makes too narrow, and neighbours beside a stone."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.drops import (
    BESIDE,
    HEIGHT,
    RISE,
    TOP,
    DropRules,
    measured_at,
)
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_of

from executive.geometry.pose import pose
from executive.messages.building import StandingStone
from executive.testing.exercises.building import bare, box

RULES = DropRules(0.03, 0.0, 0.0, 1)
NEXT = box("next", 0.7, 0.6, 0.35)


@pytest.mark.parametrize(("gap_m", "fits"), [(0.76, False), (1.0, True)])
def test_a_gap_needs_room_for_the_noise_of_a_release(gap_m, fits) -> None:
    """A stone of 0.7 m between two boxes: let go 7 cm aside it lands on one of them, or not."""
    sides = [
        StandingStone(box(f"side_{k}", 0.9, 0.7, 0.4), pose(t=np.array([x, 0.0, 0.2])))
        for k, x in enumerate((-0.45 - gap_m / 2, 0.45 + gap_m / 2))
    ]
    raster = raster_of(NEXT.vertices, NEXT.triangles, np.eye(3), 0.05)
    wall = WallTop(bare().with_standing(*sides), 0.05, 0.075)
    middle = np.array([[0, 0]]) - wall.corner
    (found,) = measured_at(middle, wall, raster, RULES)
    assert found[HEIGHT] == pytest.approx(0.175, abs=1e-6)
    assert found[RISE] == pytest.approx(0.0 if fits else 0.4, abs=1e-6)
    (found,) = measured_at(middle, wall, raster, replace(RULES, most_rise_m=0.1))
    assert np.isfinite(found[TOP]) == fits


def test_a_neighbour_is_beside_a_stone_up_to_15_cm_away() -> None:
    found = []
    for gap_m in (0.06, 0.3):
        side = StandingStone(box("side", 0.9, 0.6, 0.4), pose(t=np.array([0.8 + gap_m, 0.0, 0.2])))
        wall = WallTop(bare().with_standing(side), 0.05)
        raster = raster_of(NEXT.vertices, NEXT.triangles, np.eye(3), 0.05)
        found.append(measured_at(-wall.corner[None], wall, raster, RULES)[0, BESIDE])
    assert 0.15 < found[0] < 0.4  # one of the two short sides of four
    assert found[1] == 0.0
