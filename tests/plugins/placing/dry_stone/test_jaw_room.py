"""Room for jaws beside stones that stand: of one grasp at least, and none below them."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.height_maps import HeightMaps
from executive_plugins.placing.dry_stone.jaw_room import has_room
from executive_plugins.placing.dry_stone.rasters import WallTop
from executive_plugins.placing.dry_stone.settings import GeneratorSettings

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure

CELL_M = 0.05
CORNERS = np.array([[x, y, z] for x in (-0.4, 0.4) for y in (-0.3, 0.3) for z in (-0.25, 0.25)])
BLOCK = SolidStone("block", *hull_mesh(CORNERS), 500.0)
WALL = Structure("wall", np.array([[-3.0, 0.0], [3.0, 0.0]]), 1.3, 1.5)
BESIDE_M = 0.7  # of the jaws from the middle of the stone
UP = np.array([0.0, 0.0, 1.0])


def built(*x: float) -> AsBuilt:
    ground = HeightGrid.plane(np.full(2, -4.0), np.full(2, 4.0))
    stones = [StandingStone(BLOCK, pose(t=np.array([at, 0.0, 0.25]))) for at in x]
    return AsBuilt(WALL, ground).with_standing(*stones)


def jaws(turn_rad: float) -> Float:
    """Return points on two jaws, beside a stone along x or where that is turned to."""
    y, z = (one.ravel() for one in np.mgrid[-0.25:0.26:0.05, -0.2:0.5:0.05])
    sides = [np.column_stack([np.full(len(y), side * BESIDE_M), y, z]) for side in (-1, 1)]
    return np.concatenate(sides) @ about_axis(UP, turn_rad).T


ALONG, ACROSS = jaws(0.0), jaws(np.pi / 2)


def free(site: AsBuilt, grasps: tuple[Float, ...], x: float, z: float = 0.25) -> bool:
    wall = WallTop(site, CELL_M)
    node = np.rint(np.array([[x, 0.0]]) / CELL_M).astype(np.int64) - wall.corner
    return bool(has_room(wall, node, np.array([z]), grasps, np.eye(3))[0])


@pytest.mark.parametrize(
    ("grasps", "x", "is_free"),
    [
        ((ALONG,), 0.9, False),  # the middle of the jaw would be in the neighbour
        ((ALONG,), 1.2, True),
        ((ACROSS,), 0.9, True),
        ((ALONG, ACROSS), 0.9, True),
    ],
)
def test_jaws_need_the_gap_in_which_they_are(grasps, x: float, is_free: bool) -> None:
    assert free(built(0.0), grasps, x) == is_free


def test_the_ground_and_what_is_below_are_not_in_the_way() -> None:
    assert free(built(), (ALONG,), 0.0, z=0.1)  # the jaws end below the ground
    assert free(built(-0.4, 0.4), (ALONG,), 0.0, z=0.75)
    assert not free(built(-0.4, 0.4), (ALONG,), 0.0, z=0.65)


@pytest.mark.parametrize(("above_m", "is_free"), [(0.03, False), (0.07, True)])
def test_jaws_keep_five_centimetres_above_a_neighbour(above_m: float, is_free: bool) -> None:
    assert free(built(0.0), (ALONG,), 0.9, z=0.5 + 0.2 + above_m) == is_free


@pytest.mark.parametrize("grasps", [(), (ALONG,), (ALONG, ACROSS)])
def test_places_without_room_are_not_proposed(grasps: tuple[Float, ...]) -> None:
    settings = GeneratorSettings(attitude="kept", turns=1, stride=1)
    stone = SolidStone("next", BLOCK.vertices, BLOCK.triangles, 500.0, jaws=grasps)
    (found,) = HeightMaps(settings).places(
        built(0.0), [stone], np.random.default_rng(0), lambda: True
    )
    (places,) = found
    low = places.origins_map[places.origins_map[:, 2] < 0.3]
    nearest_m = np.abs(low[:, 0]).min()
    assert nearest_m > 1.1 if grasps == (ALONG,) else nearest_m < 1.0
