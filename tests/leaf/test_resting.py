"""The attitude in which a stone rests, and how it hangs over that."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.arrays import Float
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import angle_between, from_rpy
from executive.leaf.resting import hung_over, to_rest

SIDES_M = np.array([1.0, 0.6, 0.5])
CENTRE_M = np.array([2.0, 1.0, 0.25])
AT_REST = pose(from_rpy(0.0, 0.0, 1.1), np.array([-1.0, 5.0, 0.7]))
GRASPED_M = np.array([0.1, 0.0, 0.2])  # above the centre of the block, in its frame


def hanging(tilt_rad: float) -> tuple[SimpleNamespace, Float, Float]:
    """Return a block that has turned in the jaws, how it tilts back, and the grasp centre."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2 * SIDES_M
    T = pose(from_rpy(0.0, tilt_rad, 0.0), CENTRE_M + [0.0, 0.0, 1.0])
    stone = SimpleNamespace(
        id=1, T_map_object=T, points_map=transform(T, corners), centroid_map=T[:3, 3]
    )
    lay = SimpleNamespace(kind="grasp", T_map_object=pose(np.eye(3), CENTRE_M))
    level = to_rest(stone, SimpleNamespace(history=lambda _: [lay]))
    return stone, level, transform(T, GRASPED_M[None])[0]


@pytest.mark.parametrize("tilt_rad", [0.1, 0.4, -0.4])
def test_a_stone_hangs_over_its_place_by_the_point_about_which_it_turned(tilt_rad: float) -> None:
    stone, level, centre_map = hanging(tilt_rad)
    T = hung_over(stone, level, AT_REST, centre_map)
    assert T is not None
    assert angle_between(T[:3, :3], AT_REST[:3, :3]) == pytest.approx(abs(tilt_rad))
    off = transform(T, GRASPED_M[None])[0] - transform(AT_REST, GRASPED_M[None])[0]
    np.testing.assert_allclose(off[:2], 0.0, atol=1e-9)
    lowest = [transform(one, SIDES_M / 2 * np.array([[-1, -1, -1], [1, -1, -1]]))[:, 2].min()
              for one in (T, AT_REST)]  # fmt: skip
    assert lowest[0] >= lowest[1] - 1e-9


@pytest.mark.parametrize(("tilt_rad", "tilts_back"), [(1.0, True), (1.2, False)])
def test_a_block_of_1_by_half_a_metre_tilts_back_up_to_63_degrees(
    tilt_rad: float, tilts_back: bool
) -> None:
    """Its centre is above the edge that it stands on at atan(1.0 / 0.5), 1.11 rad."""
    assert (hung_over(*reordered(*hanging(tilt_rad))) is not None) is tilts_back


def reordered(
    stone: SimpleNamespace, level: Float, centre_map: Float
) -> tuple[SimpleNamespace, Float, Float, Float]:
    return stone, level, AT_REST, centre_map
