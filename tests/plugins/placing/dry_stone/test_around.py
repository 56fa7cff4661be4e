"""Stones that lie around a structure: nothing is set down over them, and they are none of it."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.rasters import WallTop

from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure

CELL_M = 0.05
CORNERS = np.array([[x, y, z] for x in (-0.4, 0.4) for y in (-0.3, 0.3) for z in (-0.25, 0.25)])
BLOCK = SolidStone("block", *hull_mesh(CORNERS), 500.0)
WALL = Structure("wall", np.array([[-3.0, 0.0], [3.0, 0.0]]), 1.3, 0.5)
BARE = AsBuilt(WALL, HeightGrid.plane(np.full(2, -4.0), np.full(2, 4.0)))


def lying(x: float, y: float) -> StandingStone:
    return StandingStone(BLOCK, pose(t=np.array([x, y, 0.25])))


def top_at(wall: WallTop, x: float, y: float) -> float:
    i, j = np.rint(np.array([x, y]) / CELL_M).astype(int) - wall.corner
    return float(wall.top[i, j])


@pytest.mark.parametrize(
    ("x", "y", "is_barred"),
    [(0.0, 0.9, True), (2.9, 0.0, True), (0.0, 3.0, False), (-9.0, 0.0, False), (0, -9, False)],
)
def test_nothing_is_set_down_over_a_stone_that_lies_there(x: float, y: float, is_barred) -> None:
    wall = WallTop(replace(BARE, around=(lying(x, y),)), CELL_M)
    assert (wall.top.max() > 100.0) == is_barred
    assert top_at(wall, -1.5, 0.0) == 0.0
    if is_barred:
        assert top_at(wall, x, y - 0.25) > 100.0


def test_it_is_neither_built_nor_something_to_lean_on() -> None:
    standing = WallTop(replace(BARE, standing=(lying(0.0, 0.0),)), CELL_M)
    around = WallTop(replace(BARE, around=(lying(0.0, 0.0),)), CELL_M)
    assert standing.share_up_to(0.4) > 0.1
    assert around.share_up_to(0.4) == 0.0
    assert around.owner.max() == -1
    assert around.near.max() == 0.0
