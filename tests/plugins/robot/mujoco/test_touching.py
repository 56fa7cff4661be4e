"""What stones touch, from cubes whose gaps are known."""

from types import SimpleNamespace

import numpy as np
from executive_plugins.robot.mujoco.site.terrain import TERRAIN
from executive_plugins.robot.mujoco.truth.touching import touching

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy

CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
SLOPE = SimpleNamespace(height_at=lambda xy: 0.1 * xy[:, 0])


def told(*places: tuple[float, float, float], yaw_rad: float = 0.0) -> list[tuple[str, ...]]:
    """Return what cubes of 1 m on a slope of 10 % touch that stand at places."""
    stones = [SimpleNamespace(name=f"stone_{k}", hull=CUBE) for k in range(len(places))]
    T = [pose(from_rpy(0.0, 0.0, yaw_rad), np.array(place)) for place in places]
    return touching(SimpleNamespace(stones=stones, terrain=SLOPE), T)


def test_neighbours_touch_up_to_two_centimetres() -> None:
    assert told((0, 0, 5), (1.019, 0, 5)) == [("stone_1",), ("stone_0",)]
    assert told((0, 0, 5), (1.021, 0, 5)) == [(), ()]
    assert told((0, 0, 5), (0.9, 0, 5)) == [("stone_1",), ("stone_0",)]  # they overlap
    # Turned by 45 degrees, corners meet.
    reach_m = np.sqrt(2)
    assert told((0, 0, 5), (reach_m + 0.01, 0, 5), yaw_rad=np.pi / 4)[0] == ("stone_1",)
    assert told((0, 0, 5), (reach_m + 0.03, 0, 5), yaw_rad=np.pi / 4)[0] == ()


def test_the_ground_is_touched_by_the_lowest_corner() -> None:
    # At x from 1.5 to 2.5 the ground under the upper edge is at 0.25 m.
    assert told((2.0, 0, 0.75 + 0.029)) == [(TERRAIN,)]
    assert told((2.0, 0, 0.75 + 0.031)) == [()]


def test_in_a_pile_each_stone_is_told_once_and_in_order() -> None:
    pile = told((0, 0, 0.55), (1.0, 0, 0.65), (0.5, 0, 1.56))
    assert pile == [
        ("stone_1", "stone_2", TERRAIN),
        ("stone_0", "stone_2", TERRAIN),
        ("stone_0", "stone_1"),
    ]
