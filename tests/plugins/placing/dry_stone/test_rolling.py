"""A stone rolls on height maps to where geometry says that it rests, and off an edge."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_of
from executive_plugins.placing.dry_stone.rolling import roll, underside_of

from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.messages.building import StandingStone
from executive.testing.exercises.building import bare, box

CELL_M = 0.05


def underside(stone, R=None):
    turned = np.eye(3) if R is None else R
    return underside_of(raster_of(stone.vertices, stone.triangles, turned, CELL_M), CELL_M)


@pytest.mark.parametrize("tilt", [(0.12, 0.0), (0.0, -0.16), (0.1, 0.1)])
def test_a_leaning_box_turns_back_about_the_edge_on_which_it_stands(tilt) -> None:
    wall, stone = WallTop(bare(), CELL_M), box("a", 0.9, 0.6, 0.3)
    R = exp_so3(np.array([*tilt, 0.0]))
    found = roll(underside(stone, R), wall, np.zeros(2), np.zeros(2), 0.5)
    assert found.is_at_rest
    np.testing.assert_allclose(found.tilt, -np.array(tilt), atol=0.02)  # two of its last steps
    # About an edge that stays, the middle of a box goes aside by what it is above that edge.
    assert np.linalg.norm(found.xy) > 0.5 * 0.15 * np.linalg.norm(tilt)


def test_a_box_over_an_edge_rolls_off_it() -> None:
    stand = StandingStone(box("stand", 1.0, 0.6, 0.5), pose(t=np.array([0.0, 0.0, 0.25])))
    wall, stone = WallTop(bare().with_standing(stand), CELL_M), box("a", 0.4, 0.4, 0.3)
    assert roll(underside(stone), wall, np.array([0.3, 0.0]), np.zeros(2), 0.35).is_at_rest
    assert not roll(underside(stone), wall, np.array([0.6, 0.0]), np.zeros(2), 0.35).is_at_rest


def test_a_stone_in_the_air_of_no_grid_has_no_height() -> None:
    wall = WallTop(bare(), CELL_M)
    far = roll(underside(box("a", 0.4, 0.4, 0.3)), wall, np.array([99.0, 0.0]), np.zeros(2), 0.5)
    assert far.height_m == -np.inf
