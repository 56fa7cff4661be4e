"""How firmly a stone stands is told from height maps, and decides what is checked first."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.footing import Footing, Noise, footing
from executive_plugins.placing.dry_stone.parts import Place, Stability
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_of
from executive_plugins.placing.dry_stone.rolling import underside_of
from executive_plugins.placing.dry_stone.settings import CheckSettings, DryStoneSettings

from executive.geometry.pose import pose
from executive.messages.building import AsBuilt, StandingStone
from executive.testing.exercises.building import bare, box

CELL_M = 0.05
NOISE = Noise(CheckSettings())


def on(built: AsBuilt, x_m: float, most_rad: float = 0.35) -> Footing:
    """Return how a box of 0.6 × 0.5 × 0.4 m stands at a place along a wall."""
    stone, wall = box("a", 0.6, 0.5, 0.4), WallTop(built, CELL_M)
    points = underside_of(raster_of(stone.vertices, stone.triangles, np.eye(3), CELL_M), CELL_M)
    return footing(points, wall, np.array([x_m, 0.0]), NOISE, most_rad)


def table(length_m: float) -> AsBuilt:
    stand = StandingStone(box("stand", length_m, 0.7, 0.5), pose(t=np.array([0.0, 0.0, 0.25])))
    return bare().with_standing(stand)


def test_a_stone_on_a_broad_bed_stands_in_spite_of_noise() -> None:
    found = on(table(1.2), 0.0)
    assert found.tilt_rad < 0.02
    assert found.turned_rad < 0.02
    assert found.chance > 0.5


def test_a_stone_on_a_post_stands_by_itself_and_falls_under_noise() -> None:
    found = on(table(0.1), 0.0)
    assert found.tilt_rad < 0.02
    assert found.turned_rad > 0.2
    assert found.chance < 0.01


def test_a_stone_that_tilts_too_far_is_lost_without_a_trial_under_noise() -> None:
    found = on(table(1.2), 0.85, most_rad=0.1)  # its centre is 0.25 m beyond the end
    assert found.tilt_rad > 0.1
    assert found.chance < 1e-3


@pytest.mark.parametrize("less", [Footing(0.1, 0.02), Footing(0.02, 0.1)])
def test_a_tilt_and_a_turn_under_noise_each_lower_the_chance(less: Footing) -> None:
    assert less.chance < Footing(0.02, 0.02).chance


def test_the_firm_place_is_checked_first_and_without_a_cost_the_one_that_ranks_higher() -> None:
    post = StandingStone(box("post", 0.1, 0.1, 0.5), pose(t=np.array([-1.0, 0.0, 0.25])))
    flat = StandingStone(box("flat", 0.9, 0.7, 0.5), pose(t=np.array([0.8, 0.0, 0.25])))
    built, stone = bare().with_standing(post, flat), box("a", 0.6, 0.5, 0.4)
    at = {"post": pose(t=np.array([-1.0, 0.0, 0.7])), "flat": pose(t=np.array([0.8, 0.0, 0.7]))}
    places = [Place(stone, at["post"], 5.0, {}), Place(stone, at["flat"], 4.5, {})]
    first = {}
    for cost in (0.0, 0.1):
        planner = DryStone(DryStoneSettings.model_validate({
            "check": {"cost": cost}, "generator": {"attitude": "kept"},
        }))  # fmt: skip
        first[cost] = planner_order(planner, built, stone, places)
    assert first == {0.0: -1.0, 0.1: 0.8}


def planner_order(planner, built, stone, places) -> float:
    """Return where along the wall the place is that the planner checks first."""
    seen = []

    def check(place, built, rng, may_go_on):
        seen.append(float(place.T_map_stone[0, 3]))
        return Stability("topples", place.T_map_stone, 0.0, 0.0, {})

    planner._check.check = check
    planner._best = lambda found, kept, search: places if found else []
    planner.propose(built, [stone], np.random.default_rng(0))
    return seen[0]
