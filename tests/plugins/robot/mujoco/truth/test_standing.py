"""What really stands of a structure: which stones, in which shape, on which ground."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.terrain import Terrain
from executive_plugins.robot.mujoco.truth.standing import as_built, stones_over

from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.messages.structure import Structure

WALL = Structure("wall", np.array([[-3.0, 6.0], [3.0, 6.0]]), 1.3, 1.5)
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)


def at(x: float, y: float, z: float = 0.5) -> np.ndarray:
    return pose(t=np.array([x, y, z]))


def test_a_stone_stands_whose_middle_is_over_the_foot() -> None:
    poses = [at(0.0, 6.6), at(0.0, 6.7), at(3.1, 6.0), at(-2.9, 5.4), at(1.0, 6.0, 40.0)]
    assert stones_over(WALL, poses) == [0, 3, 4]
    assert stones_over(WALL, []) == []


@pytest.fixture
def site() -> SimpleNamespace:
    skin = hull_mesh(CORNERS)
    stones = [StoneModel.from_skin(f"stone_{n}", skin, 100.0 * n) for n in (1, 2, 3)]
    grid = np.linspace(-10.0, 10.0, 201)
    slope = np.broadcast_to(0.1 * grid[:, None], (201, 201))
    return SimpleNamespace(stones=stones, terrain=Terrain(grid, slope))


def test_the_judge_gets_the_shapes_that_touch_with_the_masses_of_the_skins(site) -> None:
    built = as_built(WALL, site, [at(0.0, 6.0, 1.6), at(0.0, 0.0), at(0.5, 6.0, 0.6)])
    assert [one.stone.name for one in built.standing] == ["stone_3", "stone_1"]  # lowest first
    lowest = built.standing[0]
    assert lowest.stone.mass_kg == pytest.approx(300.0)
    assert lowest.stone.volume_m3 == pytest.approx(1.0)
    assert lowest.T_map_stone[:3, 3].tolist() == [0.5, 6.0, 0.6]
    assert lowest.vertices_map()[:, 2].min() == pytest.approx(0.1)


def test_what_stands_beside_the_foot_and_touches_the_structure_belongs_to_it(site) -> None:
    """The second stone leans on the first, the third on the second; neither is over the foot."""
    built = as_built(WALL, site, [at(0.0, 6.0), at(0.0, 7.01), at(0.0, 8.02)])
    assert {one.stone.name for one in built.standing} == {"stone_1", "stone_2", "stone_3"}
    apart = as_built(WALL, site, [at(0.0, 6.0), at(0.0, 7.1), at(0.0, 8.2)])
    assert [one.stone.name for one in apart.standing] == ["stone_1"]


def test_the_ground_has_the_nodes_of_the_site_two_metres_around_the_structure(site) -> None:
    ground = as_built(WALL, site, []).ground
    there = np.array([[-3.0, 6.0], [0.0, 6.0], [4.9, 8.5]])
    assert ground.at(there) == pytest.approx(0.1 * there[:, 0])
    assert ground.corner.tolist() == pytest.approx([-5.7, 3.3])
    assert ground.cell_m == pytest.approx(0.1)
    assert ground.heights.shape == (115, 55)


def test_ground_ends_where_the_site_does(site) -> None:
    far = Structure("far", np.array([[9.0, 9.0], [9.5, 9.0]]), 1.0, 1.0)
    ground = as_built(far, site, []).ground
    assert ground.corner.tolist() == pytest.approx([6.5, 6.5])
    assert ground.heights.shape == (36, 36)
