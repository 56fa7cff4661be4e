"""Leaves that see the site, ticked in a tree to success and to failure."""

from dataclasses import replace

import numpy as np
import pytest

from executive.behaviours.find_slots import FindSlots
from executive.behaviours.localise import Localise
from executive.behaviours.register_drone_map import RegisterDroneMap
from executive.behaviours.scan_swing import ScanSwing
from executive.behaviours.segment import SegmentMap
from executive.behaviours.survey_site import SurveySite
from executive.behaviours.wait_for_density import WaitForDensity
from executive.errors import DataError
from executive.events.site import (
    Localised,
    MapDense,
    SiteScanned,
    SiteSegmented,
    SiteSurveyed,
    SlotsFound,
    SurveyFitted,
    SurveyRegistered,
)
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.placing import PlacementPlanner
from executive.interfaces.registration import Registrar
from executive.interfaces.robot import Robot
from executive.interfaces.segmentation import Segmenter
from executive.interfaces.surveying import Survey
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.command import Follow, SwitchLidars
from executive.messages.placement import Slot
from executive.messages.region import Region
from executive.messages.request import MotionPlan
from executive.messages.segment import LeftOut, PartKind, Segmentation
from executive.messages.segment import Segment as Part
from executive.messages.stone import StoneState
from executive.messages.trajectory import JointTrajectory

SURVEY = Cloud("survey", np.random.default_rng(0).uniform(-2, 2, (30, 3)))
FLAT = np.array([0.0, 0.0, 1.0, 0.0])


def segmentation(*parts):
    found = (Part(i, p, p.mean(axis=0), np.ptp(p, axis=0)) for i, p in enumerate(parts))
    return Segmentation("map", tuple(found), Cloud("map", np.zeros((1, 3))), FLAT)


def merged(clouds):
    return Cloud("map", np.concatenate([cloud.points for cloud in clouds]))


def test_localise_waits_until_the_estimate_is_usable(stage):
    stand = stage.Stage()
    context = stand.leaf_context
    ready = context.state

    def state():
        return replace(ready(), status="GLOBAL" if context.time_s >= 1.0 else "INITIALISING")

    context.state = state
    ended = stand.tick(Localise)
    assert ended.status == "SUCCESS"
    assert context.time_s == pytest.approx(1.0, abs=0.06)
    (event,) = ended.events
    assert isinstance(event, Localised)
    assert event.status == "GLOBAL"
    np.testing.assert_array_equal(event.T_map_base, np.eye(4))


def test_localise_goes_on_waiting_for_an_estimate_that_never_comes(stage):
    stand = stage.Stage()
    state = stand.leaf_context.state
    stand.leaf_context.state = lambda: replace(state(), status="INITIALISING")
    ended = stand.tick(Localise, limit_s=5.0)
    assert (ended.status, ended.events) == ("INVALID", [])  # halted, as a `timeout` would


def test_the_survey_is_handed_on(stage):
    survey = stage.Scripted(Survey, survey=SURVEY)
    ended = stage.Stage(surveying=survey).tick(SurveySite)
    assert ended.status == "SUCCESS"
    assert ended.outputs["survey"] is SURVEY
    assert [event.points for event in ended.events if isinstance(event, SiteSurveyed)] == [30]
    assert [set(arguments) for arguments in survey.calls("survey")] == [{"rng"}]


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (Cloud("survey", np.zeros((0, 3))), "the survey holds no points"),
        (DataError("drone.ply: cut off"), "drone.ply: cut off"),
    ],
)
def test_a_survey_that_cannot_be_used_is_a_failure(stage, answer, reason):
    ended = stage.Stage(surveying=stage.Scripted(Survey, survey=answer)).tick(SurveySite)
    assert (ended.status, ended.reason, ended.events) == ("FAILURE", reason, [])


def swing(context):
    """Return a swing by half a radian in two seconds, and let the joints follow it."""
    start = context.arm()
    position = np.stack([start, start + [0.5, *[0.0] * (len(start) - 1)]])
    context.positions = lambda t: position[0] + (position[1] - position[0]) * min(t / 2.0, 1.0)
    names = context.machine().arm_names
    return JointTrajectory(names, np.array([0.0, 2.0]), position, np.zeros_like(position))


def test_the_lidars_are_on_while_the_cabin_swings(stage):
    robot, motion = stage.Scripted(Robot), stage.Scripted(MotionPlanner)
    stand = stage.Stage(robot=robot, motion=motion, mapping=stage.PointMap(np.ones((7, 3))))
    trajectory = swing(stand.leaf_context)
    motion._answers["swing"] = MotionPlan(trajectory, "", np.zeros((0, 3)))
    ended = stand.tick(ScanSwing, settings={"angle": 1.5, "duration": 2.0})
    assert (ended.status, ended.reason) == ("SUCCESS", "7 points in the map")
    commands = [arguments["command"] for arguments in robot.calls("command")]
    assert [type(command) for command in commands] == [SwitchLidars, Follow, SwitchLidars]
    assert [command.on for command in commands[::2]] == [True, False]
    assert commands[1].trajectory is trajectory
    (asked,) = motion.calls("swing")
    assert (asked["angle_rad"], asked["duration_s"]) == (1.5, 2.0)
    assert len(asked["around"].obstacles) == 7
    assert [event.points for event in ended.events if isinstance(event, SiteScanned)] == [7]


def test_without_a_swing_the_lidars_stay_off(stage):
    robot = stage.Scripted(Robot)
    refused = MotionPlan(None, "the arm would hit the ground", np.zeros((0, 3)))
    motion = stage.Scripted(MotionPlanner, swing=refused)
    ended = stage.Stage(robot=robot, motion=motion, mapping=stage.PointMap([])).tick(ScanSwing)
    assert (ended.status, ended.reason) == ("FAILURE", "no swing: the arm would hit the ground")
    assert robot.asked == []


def test_the_density_of_the_region_is_waited_for(stage):
    grid = np.stack(np.meshgrid(np.arange(-12, 12, 0.1), np.arange(-12, 12, 0.1)), -1)
    ground = np.column_stack([grid.reshape(-1, 2), np.zeros(grid.size // 2)])
    dense = stage.Stage(mapping=stage.PointMap(ground)).tick(
        WaitForDensity, settings={"density": 50.0}
    )
    assert dense.status == "SUCCESS"
    (event,) = dense.events
    assert isinstance(event, MapDense)
    assert event.share == 1.0
    thin = stage.Stage(mapping=stage.PointMap(ground[::40]))
    assert thin.tick(WaitForDensity, settings={"density": 50.0}).status == "INVALID"  # halted


def alignment(accepted):
    T = np.eye(4)
    T[:3, 3] = [1.0, 2.0, 0.0]
    return Alignment(T, accepted, "rmse 4 cm", 0.04, 0.9, ((0, 0), (1, 1)), 2.0)


def test_the_drones_map_is_brought_into_the_map(stage):
    points = np.ones((9, 3))
    registrar = stage.Scripted(Registrar, register=alignment(True))
    stand = stage.Stage(mapping=stage.PointMap(points), registration=registrar)
    ended = stand.tick(RegisterDroneMap, survey=SURVEY)
    assert (ended.status, ended.reason) == ("SUCCESS", "rmse 40 mm")
    drone_map = ended.outputs["drone_map"]
    assert drone_map.frame == "map"
    np.testing.assert_allclose(drone_map.points, 2.0 * SURVEY.points + [1.0, 2.0, 0.0])
    (asked,) = registrar.calls("register")
    assert asked["source"] is SURVEY
    np.testing.assert_array_equal(asked["target"].points, points)
    (event,) = ended.events
    assert isinstance(event, SurveyRegistered)
    assert (event.accepted, event.scale, event.matched_segments) == (True, 2.0, 2)


def test_a_registration_that_is_refused_is_recorded_and_a_failure(stage):
    registrar = stage.Scripted(Registrar, register=alignment(False))
    stand = stage.Stage(mapping=stage.PointMap(np.ones((9, 3))), registration=registrar)
    ended = stand.tick(RegisterDroneMap, survey=SURVEY)
    assert (ended.status, ended.reason) == ("FAILURE", "registration refused: rmse 4 cm")
    assert "drone_map" not in ended.outputs
    assert [event.accepted for event in ended.events] == [False]


@pytest.mark.parametrize("is_final", [True, False])
def test_a_survey_that_can_never_be_registered_is_not_tried_again(stage, is_final):
    refused = replace(alignment(False), is_final=is_final)
    registrar = stage.Scripted(Registrar, register=refused)
    stand = stage.Stage(mapping=stage.PointMap(np.ones((9, 3))), registration=registrar)
    assert stand.tick(RegisterDroneMap, survey=SURVEY).is_final == is_final


@pytest.mark.parametrize("leaf", [RegisterDroneMap, SegmentMap])
def test_an_empty_map_is_not_worked_on(stage, database, leaf):
    registrar, segmenter = stage.Scripted(Registrar), stage.Scripted(Segmenter, merge=merged)
    stand = stage.Stage(
        mapping=stage.PointMap([]),
        registration=registrar,
        segmentation=segmenter,
        objects=database,
    )
    ended = stand.tick(leaf, **({"survey": SURVEY} if leaf is RegisterDroneMap else {}))
    assert (ended.status, ended.reason) == ("FAILURE", "the map is empty: scan first")
    assert registrar.asked == segmenter.calls("segment") == []


@pytest.mark.parametrize("has_drone_map", [True, False])
def test_the_merged_map_is_segmented_and_the_stones_are_entered(stage, database, has_drone_map):
    lidar, drone = stage.block((5.0, 0.0, 0.3)), stage.block((6.0, -3.0, 0.3), seed=2)
    far = np.array([[40.0, 0.0, 0.0]])
    found = segmentation(stage.block((5.0, 0.0, 0.3), seed=3), drone)
    segmenter = stage.Scripted(Segmenter, segment=found, merge=merged)
    stand = stage.Stage(mapping=stage.PointMap(lidar), segmentation=segmenter, objects=database)
    given = {"drone_map": Cloud("map", np.vstack([drone, far]))} if has_drone_map else {}
    ended = stand.tick(SegmentMap, **given)
    assert (ended.status, ended.reason) == ("SUCCESS", "2 stones")
    assert ended.outputs["segmentation"] is found
    assert [stone.id for stone in ended.outputs["stones"]] == [1, 3]
    (asked,) = segmenter.calls("segment")
    # The drone's part reaches to y = -3 m; what the arm cannot reach is left out.
    assert (asked["cloud"].points[:, 1].min() < -2.0) == has_drone_map
    assert asked["cloud"].points[:, 0].max() < 20.0
    assert database.stone(1).seen_from_above == has_drone_map
    assert [event.stones for event in ended.events if isinstance(event, SiteSegmented)] == [(1, 3)]


def test_a_survey_that_lies_a_little_off_is_laid_onto_the_map_before_they_are_merged(
    stage, database
):
    grid = np.stack(np.meshgrid(*[np.arange(0, 4, 0.05)] * 2), axis=-1).reshape(-1, 2)
    lidar = np.c_[grid + [3.0, -2.0], np.zeros(len(grid))]
    segmenter = stage.Scripted(Segmenter, segment=segmentation(lidar), merge=merged)
    stand = stage.Stage(mapping=stage.PointMap(lidar), segmentation=segmenter, objects=database)
    survey = Cloud("map", lidar + [0.0, 0.0, 0.03])
    for std_m, height_m in ((0.04, 0.0), (0.0, 0.03)):
        ended = stand.tick(SegmentMap, settings={"survey_std": std_m}, drone_map=survey)
        assert ended.status == "SUCCESS"
        surveyed = segmenter.calls("segment")[-1]["cloud"].points[len(lidar) :]
        assert surveyed[:, 2] == pytest.approx(height_m, abs=0.002)
        told = [event for event in ended.events if isinstance(event, SurveyFitted)]
        assert len(told) == (std_m > 0)
        for event in told:
            assert (event.share, event.median_m) == pytest.approx((1.0, 0.03), abs=0.002)


def test_what_is_no_stone_is_recorded_with_its_reason(stage, database):
    wall = LeftOut(PartKind.STRUCTURE, "24.0 m wide", 900, np.array([9.0, 1, 1]), np.ones(3))
    found = replace(
        segmentation(stage.block((5.0, 0.0, 0.3))),
        left_out=(wall,),
        scattered_points=7,
        warnings=("is z down?",),
    )
    segmenter = stage.Scripted(Segmenter, segment=found, merge=merged)
    mapper = stage.PointMap(stage.block((5.0, 0.0, 0.3)))
    ended = stage.Stage(mapping=mapper, segmentation=segmenter, objects=database).tick(SegmentMap)
    (event,) = [event for event in ended.events if isinstance(event, SiteSegmented)]
    (part,) = event.left_out
    assert (part.kind, part.reason, part.points) == ("structure", "24.0 m wide", 900)
    assert part.centroid_map.tolist() == [9.0, 1.0, 1.0]
    assert (event.scattered_points, event.warnings) == (7, ("is z down?",))


def test_what_moves_is_told_and_is_no_stone(stage, database):
    stone, person = stage.block((5.5, 0.5, 0.3)), stage.block((8.5, 0.5, 0.3))
    segmenter = stage.Scripted(Segmenter, segment=segmentation(person, stone), merge=merged)
    mapper = stage.PointMap(np.vstack([stone, person]))
    mapper.restless = np.array([[8, 0, 0], [8, 1, 0], [9, 0, 0]])
    ended = stage.Stage(mapping=mapper, segmentation=segmenter, objects=database).tick(SegmentMap)
    assert (ended.status, ended.reason) == ("SUCCESS", "1 stones")
    (seen,) = ended.outputs["segmentation"].segments
    assert seen.id == 0
    np.testing.assert_array_equal(seen.points, stone)
    (event,) = [event for event in ended.events if isinstance(event, SiteSegmented)]
    (part,) = event.left_out
    assert (part.kind, part.points) == ("moving", len(person))
    assert "of its points are where nothing was a moment ago" in part.reason


@pytest.mark.parametrize(("max_distance", "found"), [(None, 2), (12.0, 2), (8.0, 1), (3.0, 0)])
def test_a_stone_that_is_farther_away_than_is_looked_is_told_and_left_out(
    stage, database, max_distance, found
):
    near, far = stage.block((5.5, 0.5, 0.3)), stage.block((9.5, 0.5, 0.3))
    segmenter = stage.Scripted(Segmenter, segment=segmentation(far, near), merge=merged)
    mapper = stage.PointMap(np.vstack([near, far]))
    stand = stage.Stage(mapping=mapper, segmentation=segmenter, objects=database)
    ended = stand.tick(SegmentMap, settings={"max_distance": max_distance, "at_least": 0})
    assert ended.reason == f"{found} stones"
    (event,) = [event for event in ended.events if isinstance(event, SiteSegmented)]
    assert [part.kind for part in event.left_out] == ["far"] * (2 - found)
    if found == 1:
        assert event.left_out[0].reason == "9.5 m away, and stones are looked for up to 8 m"
        np.testing.assert_array_equal(ended.outputs["segmentation"].segments[0].points, near)


def test_a_site_on_which_all_moves_has_no_stone(stage, database):
    person = stage.block((8.5, 0.5, 0.3))
    segmenter = stage.Scripted(Segmenter, segment=segmentation(person), merge=merged)
    mapper = stage.PointMap(person)
    mapper.restless = np.unique(np.floor(person), axis=0).astype(np.int64)
    ended = stage.Stage(mapping=mapper, segmentation=segmenter, objects=database).tick(SegmentMap)
    assert (ended.status, ended.reason) == ("FAILURE", "no stone was found on the site")


@pytest.mark.parametrize(
    ("seen", "at_least", "expected"),
    [
        (0, 1, ("FAILURE", "no stone was found on the site")),
        (1, 2, ("FAILURE", "1 stones were found on the site")),
        (1, 1, ("SUCCESS", "1 stones")),
        (0, 0, ("SUCCESS", "0 stones")),
    ],
)
def test_fewer_stones_than_are_wanted_are_a_failure(stage, database, seen, at_least, expected):
    found = segmentation(*([stage.block((5.0, 0.0, 0.3))] * seen))
    segmenter = stage.Scripted(Segmenter, segment=found, merge=merged)
    mapper = stage.PointMap(np.ones((9, 3)))
    stand = stage.Stage(mapping=mapper, segmentation=segmenter, objects=database)
    ended = stand.tick(SegmentMap, settings={"at_least": at_least})
    assert (ended.status, ended.reason) == expected
    assert len(ended.outputs.get("stones", [])) == (seen if expected[0] == "SUCCESS" else 0)


def test_slots_are_found_recorded_and_shown(stage):
    slots = tuple(Slot(i, np.array([5.0, i, 0.0])) for i in (1, 2))
    planner = stage.Scripted(PlacementPlanner, slots=slots)
    seen = segmentation()
    ended = stage.Stage(placing=planner).tick(FindSlots, settings={"count": 3}, segmentation=seen)
    assert (ended.status, ended.reason) == ("SUCCESS", "2 slots")
    assert ended.outputs == {"slots": list(slots)}
    (asked,) = planner.calls("slots")
    assert (asked["segmentation"], asked["count"]) == (seen, 3)
    (event,) = ended.events
    assert isinstance(event, SlotsFound)
    assert [place.slot for place in event.slots] == [1, 2]
    assert ended.shown["slots/2"] is slots[1]


@pytest.mark.parametrize(("may_tip", "asked"), [(False, 3), (True, 5)])
def test_spare_slots_are_for_a_machine_that_may_tip(stage, may_tip, asked):
    planner = stage.Scripted(PlacementPlanner, slots=())
    stand = stage.Stage(placing=planner)
    machine = stand.leaf_context.machine()
    stance = machine.stance.model_copy(update={"is_free": may_tip})
    stand.leaf_context.machine = lambda: machine.model_copy(update={"stance": stance})
    stand.tick(FindSlots, settings={"count": 3, "spare": 2}, segmentation=segmentation())
    assert [one["count"] for one in planner.calls("slots")] == [asked]


def test_too_few_slots_are_a_failure_that_is_recorded(stage):
    planner = stage.Scripted(PlacementPlanner, slots=())
    ended = stage.Stage(placing=planner).tick(FindSlots, segmentation=segmentation())
    assert ended.status == "FAILURE"
    assert ended.reason == "there is free ground for 0 stones, and 1 are wanted"
    assert [len(event.slots) for event in ended.events] == [0]


def test_a_place_keeps_its_number_and_new_places_get_new_ones(stage):
    def slot(number, y):
        return Slot(number, np.array([5.0, y, 0.0]))

    rounds = [(slot(1, 0.0), slot(2, 2.0)), (slot(1, 4.0), slot(2, 2.03), slot(3, 0.0))]
    stand = stage.Stage(placing=stage.Scripted(PlacementPlanner, slots=rounds))
    numbers = [
        [one.id for one in stand.tick(FindSlots, segmentation=segmentation()).outputs["slots"]]
        for _ in range(2)
    ]
    assert numbers == [[1, 2], [3, 2, 1]]


def test_a_row_is_asked_for_with_the_stone_and_those_that_stand(stage, database):
    planner = stage.Scripted(PlacementPlanner, slots=())
    stand = stage.Stage(placing=planner, objects=database)
    off = Region("off", np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))
    stand.leaf_context.regions = {"off": off}
    settings = {"start": (1.0, 2.0), "heading": 1.5, "gap": 0.2, "keep_off": ("off",)}
    stand.tick(FindSlots, settings=settings, segmentation=segmentation(), for_stone=2)
    layout = planner.calls("slots")[0]["layout"]
    assert (layout.row.start_map.tolist(), layout.row.heading_rad, layout.row.gap_m) == (
        [1.0, 2.0],
        1.5,
        0.2,
    )
    assert layout.keep_off == (off,)
    assert [stone.id for stone in layout.stones] == [2]
    assert [stone.id for stone in layout.standing] == [1]


def test_places_on_given_ground_are_for_the_stones_that_lie_there_the_largest_first(
    stage, database
):
    planner = stage.Scripted(PlacementPlanner, slots=())
    stand = stage.Stage(placing=planner, objects=database)
    use = Region("use", np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))
    stand.leaf_context.regions = {"use": use}

    def layout():
        stand.tick(FindSlots, settings={"use": ("use",)}, segmentation=segmentation())
        return planner.calls("slots")[-1]["layout"]

    assert (layout().use, layout().row) == ((use,), None)
    assert [stone.id for stone in layout().stones] == [1, 2]
    assert layout().standing == ()
    database.set_state(1, StoneState.PLACED, 2.0)
    assert [stone.id for stone in layout().stones] == [2]
    assert [stone.id for stone in layout().standing] == [1]
    database.set_state(1, StoneState.LOST, 3.0)
    assert layout().standing == ()


def test_a_row_without_a_heading_is_refused():
    with pytest.raises(ValueError, match="a row needs both 'start' and 'heading'"):
        FindSlots.Settings(start=(1.0, 2.0))
