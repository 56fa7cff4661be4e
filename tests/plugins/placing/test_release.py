"""How a held stone is brought over a slot."""

import numpy as np
import pytest
from executive_plugins.placing.release import HeldStone, aligned_poses, release_poses

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis, yaw_of

BOX = np.array([[x, y, z] for x in (4.0, 5.0) for y in (1.0, 1.6) for z in (0.2, 0.6)])
MIDDLE = np.array([4.5, 1.3, 0.4])
RADIUS_M = np.hypot(0.5, 0.3)
UP = np.array([0.0, 0.0, 1.0])


def ring(height_m: float, radius_m: float = RADIUS_M + 0.3) -> np.ndarray:
    azimuths = np.linspace(0, 6, 20)
    xy = MIDDLE[:2] + radius_m * np.column_stack([np.cos(azimuths), np.sin(azimuths)])
    return np.column_stack([xy, np.full(20, height_m)])


def test_a_stone_without_ground_around_it_stands_on_its_lowest_point() -> None:
    held = HeldStone.of(BOX, np.empty((0, 3)))
    np.testing.assert_allclose(held.centre, MIDDLE)
    assert held.bottom_m == pytest.approx(0.2)
    assert held.radius_m == pytest.approx(RADIUS_M)
    shifted = held.centred(np.array([4.0, 1.0]))
    np.testing.assert_allclose(shifted.centre, [4.0, 1.0, 0.4])
    assert shifted.radius_m == pytest.approx(np.hypot(1.0, 0.6))
    assert shifted.bottom_m == held.bottom_m


@pytest.mark.parametrize(
    ("around", "bottom_m"),
    [
        (ring(0.05), 0.05),  # the foot was not seen
        (ring(0.25), 0.2),  # never above what was seen
        (ring(-0.09), -0.09),
        (ring(-0.11), 0.2),  # too far below to be its ground
        (ring(0.05, RADIUS_M + 0.49), 0.05),
        (ring(0.05, RADIUS_M + 0.51), 0.2),  # too far aside
        (np.vstack([ring(0.05), ring(0.1)[:5]]), 0.05),  # the median
    ],
)
def test_its_foot_is_on_the_ground_that_is_seen_around_it(around, bottom_m: float) -> None:
    assert HeldStone.of(BOX, around).bottom_m == pytest.approx(bottom_m)


def test_released_stones_come_with_the_cabin_first_and_then_with_turns_to_either_side() -> None:
    held = HeldStone.of(BOX, np.empty((0, 3)))
    T_map_base = pose(t=np.array([1.0, -1.0, 0.3]))
    place = np.array([-2.0, 3.0, 9.0])
    found = list(release_poses(held, place, 1.5, T_map_base, 8))
    cabin_rad = np.arctan2(4.0, -3.0) - np.arctan2(2.3, 3.5)
    turns = np.array([0, -1, 1, -2, 2, -3, 3, -4]) * np.pi / 4
    assert len(found) == 8
    for T, turn_rad in zip(found, turns, strict=True):
        assert np.cos(yaw_of(T[:3, :3]) - cabin_rad - turn_rad) == pytest.approx(1.0)
        np.testing.assert_allclose(T[:3, 2], UP, atol=1e-12)
        moved = transform(T, BOX)
        np.testing.assert_allclose(moved.mean(axis=0)[:2], place[:2], atol=1e-9)
        assert moved[:, 2].min() == pytest.approx(1.5)


def test_aligned_stones_have_the_turn_and_its_opposite_first() -> None:
    held = HeldStone.of(BOX, ring(0.1))
    found = list(aligned_poses(held, np.array([2.0, 3.0]), 1.5, 0.4, 4))
    steps = np.repeat([0, -1, 1, -2], 2) * np.pi / 4
    assert len(found) == 8
    for k, (T, step) in enumerate(zip(found, steps, strict=True)):
        expected = about_axis(UP, 0.4 + step + np.pi * (k % 2))
        np.testing.assert_allclose(T[:3, :3], expected, atol=1e-9)
        np.testing.assert_allclose(transform(T, BOX).mean(axis=0)[:2], [2.0, 3.0], atol=1e-9)
        assert transform(T, BOX)[:, 2].min() == pytest.approx(1.6)  # its foot is 0.1 m lower
