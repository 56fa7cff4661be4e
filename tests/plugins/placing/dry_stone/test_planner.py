"""The dry-stone planner on stones whose right place is known."""

import numpy as np
import pytest
from executive_plugins.physics.equilibrium import Touch, largest_load
from executive_plugins.placing.dry_stone.drops import HEIGHT, SHARE, DropRules, drops
from executive_plugins.placing.dry_stone.parts import part_of
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_of
from executive_plugins.placing.dry_stone.settings import DryStoneSettings, ScorerSettings

from executive.errors import ConfigError, DataError
from executive.messages.building import AsBuilt
from executive.messages.height_grid import HeightGrid
from executive.messages.structure import Structure
from executive.testing.exercises.building import bare, box, boxes, first_course

UNCHECKED = {"check": {"part": "none"}, "generator": {"sides": 2, "turns": 2, "cell": 0.1}}
RULES = DropRules(0.03, 0.0, 0.0, 1)


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def planner(**settings: object) -> DryStone:
    return DryStone(DryStoneSettings.model_validate({**UNCHECKED, **settings}))


class Highest:
    """A scorer of somebody else's: the higher, the better."""

    def __init__(self, settings: ScorerSettings) -> None:
        del settings

    def score(self, places, built, inventory):
        return {"mine": places.origins_map[:, 2]}


def test_a_box_over_two_boxes_rests_on_both() -> None:
    stone = box("top", 0.9, 0.6, 0.3)
    raster = raster_of(stone.vertices, stone.triangles, np.eye(3), 0.05)
    wall = WallTop(first_course(), 0.05)
    nodes, found = drops(wall, raster, RULES)
    middle = np.argmin(np.abs((nodes + wall.corner) * 0.05 - (0.5, 0.0)).sum(axis=1))
    assert found[middle, HEIGHT] == pytest.approx(0.4 + 0.15, abs=1e-6)
    assert found[middle, SHARE] < 0.6  # neither of the two bears it alone


def test_heights_follow_a_slope_of_five_degrees() -> None:
    slope = np.radians(5.0)
    ground = HeightGrid.plane(np.array([-4.0, -4.0]), np.array([4.0, 4.0]), slope)
    built = AsBuilt(bare().structure, ground)
    plan = planner().propose(built, boxes()[:1], rng())
    at = plan.targets[0].T_map_settled[:3, 3]
    above = at[2] - np.tan(slope) * at[0]
    assert 0.15 < above < 0.45  # half of a side of 0.7, 0.6 or 0.35 m, and the rise below it


def test_a_scorer_from_outside_changes_the_choice() -> None:
    mine = f"{__name__}:Highest"
    with pytest.raises(ConfigError, match="cannot be used"):
        planner(scorer={"part": "no_such_package:Highest"})
    scorer = part_of("highest", "scorer", {"highest": Highest}, ScorerSettings())
    chosen = planner()
    chosen._scorer = scorer
    standing = planner().propose(bare(), boxes(), rng()).targets[0]
    highest = chosen.propose(bare(), boxes(), rng()).targets[0]
    assert highest.terms.keys() == {"mine"}, mine
    assert highest.T_map_settled[2, 3] > standing.T_map_settled[2, 3]


@pytest.mark.parametrize(
    ("stones", "settings", "reason"),
    [
        ((), {}, "no_stones"),
        (boxes(), {"max_mass": 10.0}, "all_too_heavy"),
        ((box("needle", 2.0, 0.3, 0.3),), {}, "all_unsuitable"),
        ((box("slab", 1.2, 1.2, 0.1),), {}, "all_unsuitable"),
        ((box("huge", 1.4, 1.4, 1.4),), {"max_mass": 9e3}, "nothing_fits"),
    ],
)
def test_what_cannot_be_used_is_refused_with_its_reason(stones, settings, reason) -> None:
    plan = planner(**settings).propose(bare(), stones, rng())
    assert (plan.targets, plan.reason) == ((), reason)


def test_no_time_is_told() -> None:
    assert planner().propose(bare(), boxes(), rng(), lambda: False).reason == "out_of_time"


def test_two_stones_of_one_name_are_refused() -> None:
    with pytest.raises(DataError, match="two stones"):
        planner().propose(bare(), (boxes()[0], boxes()[0]), rng())


def test_the_plan_follows_the_structure_as_built() -> None:
    planned = planner().propose(bare(), boxes()[:1], rng()).targets[0].T_map_settled
    again = planner().propose(first_course(), boxes()[:1], rng()).targets[0].T_map_settled
    assert again[2, 3] > planned[2, 3] + 0.35


def test_a_block_on_a_plane_bears_its_friction_or_its_width() -> None:
    corners = [(x, y, 0.0) for x in (-0.2, 0.2) for y in (-0.5, 0.5)]
    touches = [Touch(-1, 0, np.array(c), np.array([0.0, 0.0, 1.0])) for c in corners]
    for height, wanted in ((0.1, 0.5), (1.0, 0.2)):  # it slides; it topples at width over height
        centre = np.array([[0.0, 0.0, height]])
        load = largest_load(touches, centre, np.array([900.0]), 0.5, np.array([1.0, 0.0, 0.0]))
        assert load == pytest.approx(wanted, abs=1e-6)


def test_forces_that_cannot_balance_are_none() -> None:
    one = [Touch(-1, 0, np.array([0.3, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))]
    centre, mass = np.array([[0.0, 0.0, 0.5]]), np.array([900.0])
    assert largest_load(one, centre, mass, 0.5, np.array([1.0, 0.0, 0.0])) is None


@pytest.mark.parametrize(
    ("line", "volume"),
    [
        ([[0.0, 0.0]], np.pi * 0.25),
        ([[0.0, 0.0], [2.0, 0.0]], 2.0),
        ([[0, 0], [1, 0], [1, 1]], 2.0),
    ],
)
def test_the_volume_of_an_envelope(line, volume) -> None:
    structure = Structure("one", np.array(line, dtype=float), 1.0, 1.0)
    assert structure.volume_m3() == pytest.approx(volume)


def test_a_ring_has_no_ends() -> None:
    angles = np.linspace(0, 2 * np.pi, 25)
    ring = Structure("ring", 2 * np.column_stack([np.cos(angles), np.sin(angles)]), 1.0, 1.0)
    depth = ring.depth_m(np.array([[2.0, 0.0], [0.0, -2.0], [0.0, 0.0]]), np.zeros(3))
    assert (depth[:2] > 0.4).all()
    assert depth[2] < 0
