"""Leaves that choose stones by criteria, ticked in a tree to success and to failure."""

import numpy as np
import pytest
from pydantic import ValidationError

from executive.behaviours.no_stone_matches import NoStoneMatches
from executive.behaviours.select_stone import SelectStone
from executive.behaviours.stones_that_match import StonesThatMatch
from executive.leaf.stone_filter import StoneFilter
from executive.messages.region import Region
from executive.messages.stone import STONE_DENSITY_KG_M3, Stone, StoneState

ON_GROUND, PLACED = StoneState.ON_GROUND, StoneState.PLACED


def stone(number: int, at: tuple[float, float], sides: tuple[float, float, float], state=ON_GROUND):
    """Return a box of stone on the ground z = 0, the points its corners."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0, 1)])
    points = corners * sides + [*at, 0.0]
    return Stone(number, state, points, points.mean(axis=0), np.eye(4), False)


class Known:
    """A database of given stones."""

    def __init__(self, *stones: Stone) -> None:
        self._stones = stones

    def stones(self):
        return self._stones


SITE = (
    stone(1, (5.0, 1.0), (1.0, 0.8, 0.5)),  # 0.40 m³
    stone(2, (5.0, -2.0), (1.5, 1.0, 0.6)),  # 0.90 m³
    stone(3, (7.0, 3.0), (0.8, 0.8, 1.0), PLACED),  # 0.64 m³, highest
    stone(4, (-4.0, 0.5), (1.0, 0.9, 0.6)),  # 0.54 m³
)


@pytest.fixture
def stand(stage):
    made = stage.Stage(objects=Known(*SITE))
    box = np.array([[3.0, -3.6], [5.6, -3.6], [5.6, 0.55], [3.0, 0.55]])
    made.leaf_context.regions = {"corridor": Region("corridor", box)}
    return made


@pytest.mark.parametrize(
    ("criteria", "ids"),
    [
        ({}, [2, 4, 1]),
        ({"order": "smallest"}, [1, 4, 2]),
        ({"order": "nearest"}, [4, 1, 2]),
        ({"order": "leftmost"}, [4, 1, 2]),
        ({"order": "longest", "states": ["on_ground", "placed"]}, [2, 1, 3, 4]),
        ({"max_volume": 0.5}, [1]),
        ({"min_volume": 0.39, "max_volume": 0.89}, [4, 1]),
        ({"min_length": 1.2}, [2]),
        ({"min_mass": 0.5 * STONE_DENSITY_KG_M3}, [2, 4]),
        ({"side": "right"}, [2]),
        ({"side": "behind"}, [4]),
        ({"states": ["placed"]}, [3]),
        ({"inside": "corridor"}, []),
        ({"touching": "corridor"}, [2]),
        ({"touching": "corridor", "margin": 0.1}, [2, 1]),
        ({"off": "corridor"}, [4, 1]),
    ],
)
def test_criteria_choose_and_order_stones(stand, criteria, ids):
    ended = stand.tick(StonesThatMatch, settings=criteria)
    assert ended.status == "SUCCESS"
    assert ended.outputs["matching"] == ids
    assert [one.id for one in ended.outputs["matching_stones"]] == ids
    chosen = stand.tick(SelectStone, settings=criteria)
    assert chosen.status == ("SUCCESS" if ids else "FAILURE")
    criteria.pop("order", None)
    assert stand.tick(NoStoneMatches, settings=criteria).status == ("FAILURE" if ids else "SUCCESS")


def test_the_chosen_stone_is_told_with_its_size(stand):
    ended = stand.tick(SelectStone, settings={"order": "largest"})
    assert ended.outputs["stone"] == 2
    assert ended.reason == "stone 2, 0.90 m³, 1.50 m long; 3 match"


def test_a_failure_names_the_criteria(stand):
    ended = stand.tick(SelectStone, settings={"min_volume": 5.0})
    assert ended.reason == "no stone matches: on_ground, min_volume 5.0"
    ended = stand.tick(NoStoneMatches, settings={"touching": "corridor"})
    assert ended.reason == "stones [2] match: on_ground, touching corridor"


def test_a_range_that_holds_nothing_is_refused():
    with pytest.raises(ValidationError, match="min_mass must be less than max_mass"):
        StoneFilter(min_mass=2.0, max_mass=1.0)


def test_a_stone_knows_its_volume_and_mass():
    one = SITE[1]
    assert one.volume_m3 == pytest.approx(0.9)
    assert one.mass_kg == pytest.approx(0.9 * STONE_DENSITY_KG_M3)
    assert (one.length_m, one.width_m, one.height_m) == pytest.approx((1.5, 1.0, 0.6))
