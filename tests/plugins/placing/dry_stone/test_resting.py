"""A stone on height maps tilts to the rest that geometry gives, or away from where it has none."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.height_maps import HeightMaps
from executive_plugins.placing.dry_stone.parts import Place, Places
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.rasters import WallTop
from executive_plugins.placing.dry_stone.resting import at_rest
from executive_plugins.placing.dry_stone.settings import DryStoneSettings

from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between, exp_so3, from_rpy
from executive.messages.building import StandingStone
from executive.testing.exercises.building import bare, box, first_course

CELL_M, MOST_RAD = 0.05, 0.35
MEASURED = ("contact_share", "largest_support_share", "depth_m", "beside_share", "bottom_m",
            "support_margin_m", "void_m3", "top_gap_m")  # fmt: skip


def node_at(wall: WallTop, x: float, y: float):
    return np.rint(np.array([x, y]) / CELL_M).astype(np.int64) - wall.corner


@pytest.mark.parametrize("tilt", [(0.12, 0.0), (0.0, -0.16), (0.1, 0.1)])
def test_a_tilted_box_lies_down_on_level_ground(tilt) -> None:
    wall = WallTop(bare(), CELL_M)
    found = at_rest(
        box("a", 0.9, 0.6, 0.3), exp_so3(np.array([*tilt, 0])), node_at(wall, 0, 0), wall, MOST_RAD
    )
    assert found is not None
    assert angle_between(found[0].R, np.eye(3)) < 0.02  # two of the last steps


def test_a_beam_on_two_boxes_leans_as_their_heights_say() -> None:
    low = StandingStone(box("low", 0.4, 0.7, 0.2), pose(t=np.array([-0.6, 0.0, 0.1])))
    high = StandingStone(box("high", 0.4, 0.7, 0.4), pose(t=np.array([0.6, 0.0, 0.2])))
    wall = WallTop(bare().with_standing(low, high), CELL_M)
    found = at_rest(box("beam", 1.5, 0.5, 0.2), np.eye(3), node_at(wall, 0.0, 0.0), wall, MOST_RAD)
    assert found is not None
    raster, node = found
    # It bears on the near edge of the high box, at 0.4 m, and on the low one where its end is.
    lean = np.arctan2(0.2, 1.15)
    assert angle_between(raster.R, from_rpy(0.0, -lean, 0.0)) < 0.05
    np.testing.assert_array_equal(node, node_at(wall, 0.0, 0.0))  # 2 cm aside is the same node


def test_a_box_beyond_the_edge_of_what_bears_it_does_not_rest() -> None:
    wall = WallTop(first_course(), CELL_M)
    tower = box("tower", 0.3, 0.3, 0.3)
    assert at_rest(tower, np.eye(3), node_at(wall, 0.0, 0.45), wall, MOST_RAD) is None


class Tilted(HeightMaps):
    """A generator that offers each stone leaning, over the middle of the wall."""

    def places(self, built, inventory, rng, may_go_on):
        for stone in inventory:
            names = "contact_share", "largest_support_share", "depth_m", "beside_share", "bottom_m"
            rest = "support_margin_m", "void_m3", "top_gap_m", "joints_closed"
            along = "along_m", "before_m", "after_m"
            measured = {name: np.zeros(1) for name in (*names, *rest, *along)}
            yield [Places(stone, exp_so3(np.array([0.12, 0, 0])), np.zeros((1, 3)), measured)]


@pytest.mark.parametrize(("rested", "lean_rad"), [(0, 0.12), (4, 0.0)])
def test_the_planner_lets_a_stone_lie_down_before_it_is_checked(rested, lean_rad) -> None:
    generator = {"part": f"{__name__}:Tilted", "rested": rested}
    settings = {"generator": generator, "check": {"part": "none"}}
    planner = DryStone(DryStoneSettings.model_validate(settings))
    plan = planner.propose(bare(), [box("a", 0.9, 0.6, 0.3)], np.random.default_rng(0))
    R = plan.targets[0].T_map_settled[:3, :3]
    assert angle_between(R, np.eye(3)) == pytest.approx(lean_rad, abs=0.04)


@pytest.mark.parametrize(("lean_deg", "rests"), [(20.0, True), (5.0, False)])
def test_a_stone_in_its_kept_attitude_leans_as_far_as_is_allowed(lean_deg, rests) -> None:
    low = StandingStone(box("low", 0.4, 0.7, 0.2), pose(t=np.array([-0.6, 0.0, 0.1])))
    high = StandingStone(box("high", 0.4, 0.7, 0.4), pose(t=np.array([0.6, 0.0, 0.2])))
    built, beam = bare().with_standing(low, high), box("beam", 1.5, 0.5, 0.2)
    given = {"generator": {"attitude": "kept", "lean": f"{lean_deg} deg"}}
    generator = HeightMaps(DryStoneSettings.model_validate(given).generator)
    place = Place(beam, pose(t=np.array([0.0, 0.0, 0.5])), 0.0, {})
    found = generator.at_rest(place, built, [beam])
    assert (found is not None) == rests
    if found is not None:
        # It bears on the near edge of the high box, at 0.4 m, and on the low one where its end is.
        lean_rad = np.arctan2(0.2, 1.15)
        assert angle_between(found.R, from_rpy(0.0, -lean_rad, 0.0)) < 0.05


def test_stones_of_kept_attitudes_stay_level_by_default() -> None:
    kept = DryStoneSettings.model_validate({"generator": {"attitude": "kept"}}).generator
    leant = kept.model_copy(update={"lean": 0.3})
    assert (kept.tilts, leant.tilts, DryStoneSettings().generator.tilts) == (False, True, True)
