"""Leaves that choose stones for a structure, ticked to success and to each typed end."""

import numpy as np
import pytest
from pydantic import ValidationError

from executive.behaviours.describe_structure import DescribeStructure
from executive.behaviours.find_own_place import FindOwnPlace
from executive.behaviours.keep_fitting_grasps import KeepFittingGrasps
from executive.behaviours.plan_building import PlanBuilding
from executive.events.site import BuildingEnded, BuildingPlanned, PlaceNotFound
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.interfaces.building import StructurePlanner
from executive.interfaces.placing import PlacementPlanner
from executive.messages.building import BuildPlan, BuildTarget
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.hold import Hold
from executive.messages.placement import Placement, Slot
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import StoneState
from executive.messages.structure import Structure

DOWN = np.array([0.0, 0.0, -1.0])
HANGING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # of the gripper
WALL = Structure("garden", np.array([[-1.0, 6.0], [1.0, 6.0]]), 1.2, 0.6)
WHY = {"2": {"slides_away": 2}, "1": {"tilts": 4, "slides_away": 1}}
REFUSED = {"slides_away": 3, "tilts": 4}
NOTHING = BuildPlan((), "nothing_fits", REFUSED, "no place holds any of 2 stones", WHY)


def ground_of(low, high):
    """Return level ground 0.1 m below the boxes of the database, as a segmented site."""
    x, y = (np.arange(low[k], high[k], 0.1) for k in (0, 1))
    grid = np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)
    points = np.column_stack([grid, np.full(len(grid), -0.1)])
    return Segmentation("map", (), Cloud("map", points), np.array([0.0, 0.0, 1.0, -0.1]))


SITE = ground_of((-4, -3), (8, 9))


def target(stone, at, worst_m=0.02):
    T = pose(t=np.array(at))
    return BuildTarget(stone, T, T, DOWN, 0.02, worst_m, 0.0, 3.0, {"contact": 0.9})


def on_stage(stage, database, plan, points=()):
    """Return a stage with a building planner that gives a plan, and that planner."""
    planner = stage.Scripted(StructurePlanner, propose=plan)
    mapping = stage.PointMap(points)
    return stage.Stage(building=planner, objects=database, mapping=mapping), planner


def set_down(database, stone, at, is_seen=True):
    """Grasp a stone, release it elsewhere, and look at it."""
    database.grasp(stone, pose(), 2.0)
    database.release(stone, pose(t=np.array(at)), 3.0, StoneState.PLACED)
    if is_seen:
        database.realign(stone, pose(t=np.array([0.0, 0.0, -0.02])), 4.0)


def test_the_best_target_becomes_a_stone_and_its_slots(stage, database):
    plan = BuildPlan((target("2", (0.2, 6, 0.4)), target("1", (0, 6, 0.4)),
                      target("2", (-0.5, 6, 0.4))), None, {"topples": 1})  # fmt: skip
    stand, planner = on_stage(stage, database, plan)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    assert ended.status == "SUCCESS"
    assert ended.outputs["stone"] == 2
    slots = ended.outputs["free_slots"]
    assert [round(float(slot.position_map[0]), 2) for slot in slots] == [0.2, -0.5]
    (asked,) = planner.calls("propose")
    assert asked["built"].structure is WALL
    assert not asked["built"].standing
    assert {one.name for one in asked["inventory"]} == {"1", "2"}
    event = next(one for one in ended.events if isinstance(one, BuildingPlanned))
    assert (event.stone, event.standing, dict(event.refused)) == (2, (), {"topples": 1})


def test_a_slot_carries_the_model_to_the_pose_of_the_target(stage, database):
    """The frame of the planner's stone is not that of the database."""
    stand, planner = on_stage(stage, database, BuildPlan((target("1", (0, 6, 0.4)),), None, {}))
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    (slot,), stone = ended.outputs["free_slots"], database.stone(1)
    T_map_map = slot.T_map_object @ inverse(stone.T_map_object)
    at_rest = transform(T_map_map, stone.points_map)
    solid = planner.calls("propose")[0]["inventory"][0]
    at_target = solid.vertices + [0, 6, 0.4]
    np.testing.assert_allclose(at_rest[:, 2].max(), at_target[:, 2].max(), atol=0.01)
    np.testing.assert_allclose(slot.position_map[2], at_target[:, 2].min(), atol=1e-9)
    # Foot and room: 0.1 m down to the ground, and 5 cm at each side.
    np.testing.assert_allclose(np.ptp(solid.vertices[:, 2]), 0.7, atol=0.01)
    assert 1.0 < np.ptp(solid.vertices[:, 0]) < 1.11


def test_the_plan_follows_the_structure_as_it_stands(stage, database):
    """A stone that was moved after it was placed is planned with where it was seen last."""
    set_down(database, 1, (-5.0, 6.0, 0.0))
    stand, planner = on_stage(stage, database, NOTHING)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    database.realign(1, pose(t=np.array([0.3, 0.0, 0.0])), 5.0)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    before, after = (call["built"].standing[0] for call in planner.calls("propose"))
    moved = after.T_map_stone[:3, 3] - before.T_map_stone[:3, 3]
    np.testing.assert_allclose(moved, [0.3, 0.0, 0.0], atol=1e-4)
    # Its foot is that of the place where it lay, though it is somewhere else now.
    np.testing.assert_allclose(np.ptp(after.stone.vertices[:, 2]), 0.7, atol=0.01)
    assert [one.name for one in planner.calls("propose")[0]["inventory"]] == ["2"]
    assert ended.outputs["ending"] == "nothing_fits"


def test_what_lies_around_the_structure_is_told_to_the_planner(stage, database):
    """But for the stone that is planned: it leaves its place."""
    stand, planner = on_stage(stage, database, NOTHING)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    set_down(database, 1, (-5.0, 6.0, 0.0))
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE, for_stone=2)
    around = [[one.stone.name for one in call["built"].around]
              for call in planner.calls("propose")]  # fmt: skip
    assert around == [["1", "2"], ["2"], []]


def test_a_stone_that_lies_within_the_structure_is_adopted_as_built(stage, database):
    """It fell there: the next stone is planned around it, and it is not taken as the next one."""
    database.grasp(1, pose(), 2.0)
    database.release(1, pose(t=np.array([-5.0, 6.0, 0.0])), 3.0, StoneState.ON_GROUND)
    stand, planner = on_stage(stage, database, NOTHING)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    (asked,) = planner.calls("propose")
    assert [one.stone.name for one in asked["built"].standing] == ["1"]
    assert [one.name for one in asked["inventory"]] == ["2"]
    (event,) = ended.events
    assert event.standing == (1,)
    # An attempt at the stone itself takes it off again.
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE, for_stone=1)
    asked = planner.calls("propose")[-1]
    assert (asked["built"].standing, [one.name for one in asked["inventory"]]) == ((), ["1"])


@pytest.mark.parametrize("is_shown", [True, False])
def test_a_lost_stone_stands_as_long_as_the_map_shows_a_body_there(stage, database, is_shown):
    set_down(database, 1, (-5.0, 6.0, 0.0))
    database.set_state(1, StoneState.LOST, 5.0)
    points = database.stone(1).points_map if is_shown else SITE.ground.points
    stand, planner = on_stage(stage, database, NOTHING, points)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    (asked,) = planner.calls("propose")
    assert [one.stone.name for one in asked["built"].standing] == (["1"] if is_shown else [])
    assert database.stone(1).state is (StoneState.PLACED if is_shown else StoneState.LOST)
    assert [one.name for one in asked["inventory"]] == ["2"]


def test_a_body_in_the_structure_that_may_be_a_lost_stone_is_built_around(stage, database):
    """It rolled by a metre as it was let go, and nobody has recognised it."""
    set_down(database, 1, (-5.0, 6.0, 0.0))
    last = database.stone(1).points_map
    database.set_state(1, StoneState.LOST, 5.0)
    body = last + (0.8, 0.0, 0.0)
    stand, planner = on_stage(stage, database, NOTHING, np.concatenate([body, SITE.ground.points]))
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    (standing,) = planner.calls("propose")[0]["built"].standing
    assert standing.stone.name == "1"
    np.testing.assert_allclose(standing.vertices_map().max(axis=0), body.max(axis=0), atol=0.01)
    assert database.stone(1).state is StoneState.LOST
    assert next(one for one in ended.events if isinstance(one, BuildingEnded)).standing == (1,)


LEFT = StoneState.PLACED, StoneState.ON_GROUND, StoneState.LOST


@pytest.mark.parametrize("shift_m", [0.1, 1.5])
@pytest.mark.parametrize("state", LEFT)
def test_a_release_onto_a_stone_that_did_not_hold_is_told_to_the_planner(
    stage, database, shift_m, state
):
    """Stone 2 is let go above stone 1, and is seen beside it, or where it was let go."""
    set_down(database, 1, (-5.0, 6.0, 0.0))
    middle = database.stone(1).T_map_object[:3, 3]
    up = middle + (0.1, 0.0, 0.6) - database.stone(2).T_map_object[:3, 3]
    database.grasp(2, pose(), 5.0)
    database.release(2, pose(t=up), 6.0, StoneState.PLACED)
    database.realign(2, pose(t=np.array([shift_m, 0.0, 0.0])), 7.0)
    database.set_state(2, state, 8.0)
    stand, planner = on_stage(stage, database, NOTHING)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    failed = planner.calls("propose")[0]["built"].failed
    if shift_m < 0.3 or state is StoneState.PLACED:
        assert failed == ()
        return
    (one,) = failed
    np.testing.assert_allclose(one.at_map, middle[:2] + (0.1, 0.0), atol=1e-6)
    assert one.supports == {"1"}
    outline_m2 = np.prod(np.ptp(database.stone(2).points_map[:, :2], axis=0))
    np.testing.assert_allclose(one.radius_m, np.sqrt(outline_m2 / np.pi), rtol=0.05)


@pytest.mark.parametrize("since", ["nothing", "let go again", "taken away"])
def test_a_release_onto_a_stone_that_stands_otherwise_since_is_not_told(stage, database, since):
    set_down(database, 1, (-5.0, 6.0, 0.0))
    up = database.stone(1).T_map_object[:3, 3] - database.stone(2).T_map_object[:3, 3]
    database.grasp(2, pose(), 5.0)
    database.release(2, pose(t=up + (0.0, 0.0, 0.6)), 6.0, StoneState.PLACED)
    database.realign(2, pose(t=np.array([0.0, 2.0, 0.0])), 7.0)
    database.set_state(2, StoneState.ON_GROUND, 8.0)
    if since != "nothing":
        database.grasp(1, pose(), 9.0)
        to = StoneState.PLACED if since == "let go again" else StoneState.ON_GROUND
        away = np.array([0.0, 0.0 if since == "let go again" else 3.0, 0.0])
        database.release(1, pose(t=away), 10.0, to)
        database.realign(1, pose(), 11.0)
    stand, planner = on_stage(stage, database, NOTHING)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    assert bool(planner.calls("propose")[0]["built"].failed) == (since == "nothing")


@pytest.mark.parametrize("has_left", [False, True])
def test_a_release_onto_two_stones_is_not_told_once_one_of_them_has_left(stage, database, has_left):
    """What left may be what gave way."""
    third = stage.block((5.0, 7.0, 0.3), seed=2)
    database.observe([Segment(0, third, third.mean(axis=0), np.ptp(third, axis=0))], 1.5, False)
    set_down(database, 1, (-5.0, 6.0, 0.0))
    database.grasp(3, pose(), 4.5)
    near = database.stone(1).T_map_object[:3, 3] - database.stone(3).T_map_object[:3, 3]
    database.release(3, pose(t=near + (0.7, 0.0, 0.0)), 4.6, StoneState.PLACED)
    database.realign(3, pose(), 4.7)
    up = database.stone(1).T_map_object[:3, 3] - database.stone(2).T_map_object[:3, 3]
    database.grasp(2, pose(), 5.0)
    database.release(2, pose(t=up + (0.35, 0.0, 0.6)), 6.0, StoneState.PLACED)
    database.realign(2, pose(t=np.array([0.0, 2.0, 0.0])), 7.0)
    database.set_state(2, StoneState.ON_GROUND, 8.0)
    if has_left:
        database.realign(3, pose(t=np.array([0.0, -3.0, 0.0])), 9.0)
        database.set_state(3, StoneState.ON_GROUND, 9.0)
    stand, planner = on_stage(stage, database, NOTHING)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    failed = planner.calls("propose")[0]["built"].failed
    assert [one.supports for one in failed] == ([] if has_left else [{"1", "3"}])


def test_a_release_onto_the_ground_is_not_told(stage, database):
    """The ground bears any stone: what did not stay there was the stone's fault."""
    set_down(database, 1, (-5.0, 6.0, 0.0))
    database.realign(1, pose(t=np.array([0.0, 2.0, 0.0])), 5.0)
    database.set_state(1, StoneState.ON_GROUND, 6.0)
    stand, planner = on_stage(stage, database, NOTHING)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    assert planner.calls("propose")[0]["built"].failed == ()


def test_an_end_has_its_reason_and_figures(stage, database):
    stand, _ = on_stage(stage, database, NOTHING)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    assert (ended.status, ended.outputs) == ("FAILURE", {"ending": "nothing_fits"})
    assert ended.reason == "nothing_fits: no place holds any of 2 stones"
    (event,) = ended.events
    assert isinstance(event, BuildingEnded)
    assert (event.reason, event.refused, event.by_stone) == ("nothing_fits", REFUSED, WHY)


def test_one_stone_without_a_place_does_not_end_the_structure(stage, database):
    stand, planner = on_stage(stage, database, NOTHING)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE, for_stone=2)
    assert (ended.status, ended.outputs) == ("FAILURE", {})
    assert ended.is_final
    (event,) = ended.events
    assert isinstance(event, PlaceNotFound)
    assert (event.stone, event.is_held, event.reason) == (2, False, "nothing_fits")
    assert event.refused == REFUSED
    told = "stone 2 has no other place: nothing_fits; 3 × slides_away, 4 × tilts"
    assert ended.reason == told
    assert [one.name for one in planner.calls("propose")[0]["inventory"]] == ["2"]


def test_a_stone_that_is_lost_is_not_planned(stage, database):
    database.set_state(2, StoneState.LOST, 5.0)
    stand, planner = on_stage(stage, database, NOTHING)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE, for_stone=2)
    assert (ended.status, ended.is_final) == ("FAILURE", True)
    assert ended.reason == "stone 2 cannot be placed: it is lost, neither held nor lying"
    assert planner.calls("propose") == []


def test_a_stone_in_the_jaws_is_planned_in_the_attitude_in_which_it_lay(stage, database):
    """The jaws have tilted it: on the structure it would come down on an edge."""
    lying = database.stone(1)
    database.grasp(1, pose(), 2.0)
    tilt = exp_so3(np.array([0.4, 0.0, 0.0]))
    middle = lying.centroid_map
    database.realign(1, pose(tilt, middle - tilt @ middle), 3.0)
    stand, planner = on_stage(stage, database, BuildPlan((target("1", (0, 6, 0.4)),), None, {}))
    # It is held from straight above, as it was in its tilt.
    T_lying_gripper = pose(HANGING, middle + [0.0, 0.0, 0.9])
    hold = Hold(1, pose(tilt, middle - tilt @ middle) @ T_lying_gripper, 0.3)
    given = {"structure": WALL, "segmentation": SITE, "for_stone": 1, "in_jaws": hold}
    ended = stand.tick(PlanBuilding, **given)
    assert (ended.status, ended.outputs["stone"]) == ("SUCCESS", 1)
    (asked,) = planner.calls("propose")
    (solid,) = asked["inventory"]
    np.testing.assert_allclose(np.ptp(solid.vertices[:, 2]), 0.7, atol=0.01)
    (jaws,) = solid.jaws
    assert np.abs(jaws[:, 1].min() + jaws[:, 1].max()) < 0.1  # upright: as far to both sides
    (slot,) = ended.outputs["free_slots"]
    np.testing.assert_allclose(slot.T_map_object[:3, :3], lying.T_map_object[:3, :3], atol=1e-6)


def test_a_stone_in_the_jaws_without_a_place_is_told_as_held(stage, database):
    database.grasp(1, pose(), 2.0)
    stand, _ = on_stage(stage, database, NOTHING)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE, for_stone=1)
    (event,) = ended.events
    assert (event.stone, event.is_held) == (1, True)


def test_a_stone_in_the_jaws_is_no_choice_unless_it_is_asked_for(stage, database):
    database.grasp(1, pose(), 2.0)
    stand, planner = on_stage(stage, database, NOTHING)
    stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    assert [one.name for one in planner.calls("propose")[0]["inventory"]] == ["2"]


def test_a_stone_is_planned_with_the_jaws_of_its_likely_grasps(stage, database):
    """They are in the stone's frame: above it, and to both sides, opened to let it go."""
    middle = database.stone(1).centroid_map
    above = pose(HANGING, middle + [0.0, 0.0, 0.9])
    grasps = [Grasp(above, 1.0, score, {}) for score in (0.9, 0.6, 0.4)]
    given = {"structure": WALL, "segmentation": SITE, "for_stone": 1}
    asked = []
    for held_by in (grasps, None):
        stand, planner = on_stage(stage, database, NOTHING)
        stand.tick(PlanBuilding, **given, held_by=held_by, least_score=0.5)
        asked += planner.calls("propose")
    likely, any_way = (call["inventory"][0] for call in asked)
    assert (len(likely.jaws), any_way.jaws) == (2, ())
    points = likely.jaws[0]
    half_m = np.abs(database.stone(1).points_map - middle).max(axis=0)
    beside = points[points[:, 2] < 0.2]
    assert (np.abs(beside[:, 1]) > half_m[1]).any()
    assert points[:, 2].max() > 0.5
    assert np.abs(points[:, 1].min() + points[:, 1].max()) < 0.1


def test_a_stone_that_was_not_seen_since_its_release_makes_the_map_stale(stage, database):
    set_down(database, 1, (-5.0, 6.0, 0.0), is_seen=False)
    stand, planner = on_stage(stage, database, NOTHING)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=SITE)
    assert ended.outputs == {"ending": "stale_map"}
    assert "stone 1 was not seen since its release" in ended.reason
    assert not planner.asked


def test_ground_that_was_not_seen_is_not_built_on(stage, database):
    stand, planner = on_stage(stage, database, NOTHING)
    ended = stand.tick(PlanBuilding, structure=WALL, segmentation=ground_of((-4, -3), (8, 5.7)))
    assert ended.outputs == {"ending": "stale_map"}
    assert "% of the ground below the structure" in ended.reason
    assert not planner.asked


def grasp(x):
    return Grasp(pose(t=np.array([x, 0.0, 0.5])), 1.0, 1.0, {})


@pytest.mark.parametrize("fitting", [{2.0}, set()])
def test_grasps_that_suit_no_slot_are_left_out(stage, database, fitting):
    slots = [Slot(1, np.array([0.0, 6.0, 0.0])), Slot(2, np.array([1.0, 6.0, 0.0]))]

    def plan(stone, slot, T_map_gripper, cloud, T_map_base):
        suits = T_map_gripper[0, 3] in fitting and slot.id == 2
        return (Placement(slot, T_map_gripper, pose()),) if suits else ()

    stand = stage.Stage(
        placing=stage.Scripted(PlacementPlanner, plan=plan),
        objects=database,
        mapping=stage.PointMap(np.zeros((0, 3))),
    )
    grasps = [grasp(1.0), grasp(2.0)]
    ended = stand.tick(KeepFittingGrasps, stone=1, grasps=grasps, free_slots=slots)
    if fitting:
        assert (ended.status, ended.outputs) == ("SUCCESS", {"fitting": grasps[1:]})
    else:
        assert ended.status == "FAILURE"
        assert "none of 2 grasps of stone 1" in ended.reason


def test_a_structure_is_described_by_settings(stage):
    given = {"line": [[0.0, 6.0], [2.0, 6.0]], "height": 0.7}
    ended = stage.Stage().tick(DescribeStructure, settings=given)
    assert (ended.status, ended.outputs["structure"].length_m) == ("SUCCESS", 2.0)


def test_a_structure_without_a_form_is_refused():
    with pytest.raises(ValidationError, match="one of line, ring, cairn; got none"):
        DescribeStructure.Settings(height=0.7)


def test_a_held_stone_has_its_own_place_where_it_lay(stage, database):
    lay = database.stone(1).points_map
    database.grasp(1, pose(), 2.0)
    database.realign(1, pose(exp_so3(np.array([0.3, 0.0, 0.0])), np.array([0.0, 0.0, 0.1])), 3.0)
    ended = stage.Stage(objects=database).tick(FindOwnPlace, stone=1)
    (slot,) = ended.outputs["slots"]
    expected = [*lay.mean(axis=0)[:2], lay[:, 2].min()]
    np.testing.assert_allclose(slot.position_map, expected, atol=1e-3)
    assert slot.T_map_object is None  # it may turn about the vertical


def test_a_stone_that_was_never_grasped_has_no_own_place(stage, database):
    ended = stage.Stage(objects=database).tick(FindOwnPlace, stone=1)
    assert (ended.status, ended.reason) == (
        "FAILURE", "stone 1 has no place of its own: it was never grasped"
    )  # fmt: skip
