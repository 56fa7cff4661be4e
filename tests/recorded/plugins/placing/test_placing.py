"""Slots and placements on small sites, and the parts that find them."""

import numpy as np
import pytest
from executive_plugins.placing.free_ground import FreeGround, GroundNeeds
from executive_plugins.placing.release import HeldStone, release_poses
from executive_plugins.placing.slot_surroundings import SlotFoot, SlotSurroundings
from executive_plugins.placing.spaced_row import spaced_row

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot

BASE = pose(from_rpy(0.0, 0.0, 0.3), np.array([0.5, -0.25, 0.9]))


def heights(xy) -> float | None:
    """Return a ground with holes along a grid."""
    return None if (np.floor(xy) % 3 == 0).any() else float(0.1 * xy[0])


def test_rows(recorded) -> None:
    told = []
    for radius, spacing, sector in (
        (6.0, 1.9, 6.28),
        (5.0, 2.0, 2.0),
        (4.0, 9.0, 6.2832),
        (4.0, 2.0, 0.1),
        (1.0, 2.0, np.pi),
        (3.0, 3.0, 2 * np.pi),
    ):
        for height_of in (heights, lambda xy: 0.5, lambda xy: None):
            told.append(spaced_row(radius, spacing, sector, BASE, height_of))
    recorded(told)


def rough(seed: int, slope: float, noise_m: float, hole_m: float = 0.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-1.5, 1.5, (2500, 2))
    xy = xy[np.linalg.norm(xy, axis=1) >= hole_m]
    return np.c_[xy, slope * xy[:, 0] + rng.normal(0, noise_m, len(xy))]


def test_free_ground(recorded, site) -> None:
    block, _, segmented, _ = site
    told = []
    for slope, noise_m, hole_m in (
        (0.0, 0.0, 0.0),
        (0.2, 0.0, 0.0),
        (0.21, 0.0, 0.0),
        (0.0, 0.045, 0.0),
        (0.0, 0.06, 0.0),
        (0.0, 0.0, 0.3),
        (0.1, 0.02, 0.45),
        (0.1, 0.02, 0.6),
    ):
        seen = segmented(rough(1, slope, noise_m, hole_m), block((1.4, 0.0)))
        ground = FreeGround(seen, GroundNeeds(0.6, float(np.arctan(0.2) + 1e-9), 0.05))
        told += [
            ground.height_m(np.array(xy)) for xy in ((0, 0), (0.35, 0.1), (0.45, 0), (-1.2, 1))
        ]
    edge = segmented(np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0]]))
    told.append(FreeGround(edge, GroundNeeds(1.0, 0.2, 0.1)).height_m(np.zeros(2)))
    recorded(told)


@pytest.mark.parametrize("turns", [1, 4, 5])
def test_releases(recorded, site, turns) -> None:
    block, level_ground, _, _ = site
    told = []
    for ground in (level_ground(3.0, -0.1), level_ground(3.0, 0.1), level_ground(3.0, -0.5)[:0]):
        held = HeldStone.of(block((1.0, 0.5)) * [1, 1.2, 1], ground)
        told.append((held.centre, held.bottom_m, held.radius_m))
        told += list(release_poses(held, np.array([-2.0, 3.0, 0.25]), 0.3, BASE, turns))
    recorded(told)


def test_surroundings(recorded, machine, site) -> None:
    block, level_ground, _, held = site
    told = []
    stone, T_map_gripper = held((0.0, 0.0))
    for distance_m in (0.7, 0.9, 1.1, 1.6, 2.5):
        cloud = np.vstack([level_ground(3.0), block((distance_m, 0.2), 0.9)])
        around = SlotSurroundings(machine.gripper, cloud, SlotFoot(np.zeros(3), 0.6))
        told.append((around.ground_m, around.is_free(T_map_gripper, stone.points_map)))
        for lower_m in (0.3, 0.6, 0.9):
            lower = pose(t=np.array([0, 0, -lower_m])) @ T_map_gripper
            told.append(around.is_free(lower, stone.points_map + [0, 0, 0.5]))
    nothing = SlotSurroundings(
        machine.gripper, level_ground(3.0)[:1], SlotFoot(np.array([0, 0, 2.0]), 0.6)
    )
    told.append((nothing.ground_m, nothing.is_free(T_map_gripper, stone.points_map)))
    recorded(told)


@pytest.mark.parametrize("count", [2, 9, 40])
def test_slots(recorded, planner_of, site, count) -> None:
    block, level_ground, segmented, _ = site
    seen = segmented(level_ground(8.0), block((5.0, 1.0)), block((-3.0, 4.0)))
    told = []
    for settings in ({}, {"radii_m": (3.0, 4.0), "sector_rad": 2.5}, {"spacing_m": 4.0}):
        told.append(planner_of((2.0, 6.6), **settings).slots(seen, BASE, count))
    recorded(told)


@pytest.mark.parametrize("most", [1, 3])
def test_placements(recorded, planner_of, site, most) -> None:
    block, level_ground, _, held = site
    stone, T_map_gripper = held((4.0, 0.0))
    told = []
    for neighbour in ((3.0, 4.6), (3.9, 3.0), (9.0, 9.0)):
        cloud = Cloud("map", np.vstack([level_ground(6.0), block(neighbour, 0.9)]))
        planner = planner_of((2.0, 6.0), max_placements=most, turns=8, drop_m=0.125)
        for place in ((3.0, 3.0, 0.0), (0.5, 5.9, 0.0), (0.0, 6.4, 0.0)):
            told.append(planner.plan(stone, Slot(1, np.array(place)), T_map_gripper, cloud, BASE))
    recorded(told)
