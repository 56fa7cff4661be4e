"""FindAgain and FindLost, ticked to success and to failure."""

from dataclasses import replace

import numpy as np
import pytest

from executive.behaviours.find_again import FindAgain
from executive.behaviours.find_lost import FindLost
from executive.behaviours.plan_grasp import PlanGrasp
from executive.behaviours.set_aside import SetAside
from executive.events.stone import StoneSoughtAgain
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import StoneState
from tests.behaviours.placing.scene import alignment, plugins


@pytest.fixture
def search(stage, world, database):
    """Return the stage with stone 2 in the map, 0.3 m beside where the database has it."""
    seen = database.stone(2).points_map + [0.3, 0.0, 0.0]
    plugins(world)["mapping"].add_surface(seen)
    part = Segment(0, seen, seen.mean(axis=0), np.ptp(seen, axis=0))
    flat = np.array([0.0, 0.0, 1.0, 0.0])
    world.segmented = Segmentation("map", (part,), Cloud("map", np.zeros((1, 3))), flat)
    world.empty = Segmentation("map", (), Cloud("map", np.zeros((1, 3))), flat)
    world.rest = (Cloud("map", np.zeros((1, 3))), flat)  # of a segmentation, beside its segments
    return world


def test_a_pushed_stone_is_found_by_its_model(stage, search, database):
    registrar = stage.Scripted(Registrar, find=alignment(True, 0.3))
    segmenter = stage.Scripted(Segmenter)
    plugins(search).update(registration=registrar, segmentation=segmenter)
    ended = search.tick(FindAgain, stone=2)
    assert (ended.status, ended.reason) == ("SUCCESS", "registration, rmse 3 cm")
    assert database.stone(2).T_map_object[0, 3] == pytest.approx(5.3, abs=0.05)
    (event,) = ended.events
    assert isinstance(event, StoneSoughtAgain)
    assert (event.stone, event.seen, event.method) == (2, (2,), "registration")
    (asked,) = registrar.calls("find")
    assert 250 < len(asked["model"].points) < 310  # the model of stone 2, thinned a little
    assert segmenter.calls("segment") == []


def test_what_registration_refuses_is_found_by_segmentation(stage, search, database):
    registrar = stage.Scripted(Registrar, find=alignment(False))
    segmenter = stage.Scripted(Segmenter, segment=search.segmented)
    plugins(search).update(registration=registrar, segmentation=segmenter)
    ended = search.tick(FindAgain, stone=2)
    assert ended.status == "SUCCESS"
    assert database.stone(2).centroid_map[0] == pytest.approx(5.3, abs=0.1)
    assert [(event.method, event.seen) for event in ended.events] == [("segmentation", (2,))]


def test_a_segment_that_is_offered_has_its_foot(stage, search, database):
    (part,) = search.segmented.segments
    foot = part.points[:3] - [0.0, 0.0, 0.5]
    footed = Segmentation("map", (replace(part, foot=foot),), *search.rest)
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(Segmenter, segment=footed),
    )
    offered = []
    observe = database.observe
    database.observe = lambda found, *rest: (offered.extend(found), observe(found, *rest))[1]
    search.tick(FindAgain, stone=2)
    (one,) = offered
    np.testing.assert_array_equal(one.points[-3:], foot)
    np.testing.assert_allclose(one.centroid, one.points.mean(axis=0))


@pytest.mark.parametrize("done", [StoneState.PLACED, StoneState.SET_ASIDE])
@pytest.mark.parametrize(("beside_m", "is_left_out"), [(0.5, True), (0.7, False)])
def test_a_segment_at_a_stone_that_is_done_is_not_taken_for_the_one_that_is_sought(
    stage, search, database, done, beside_m, is_left_out
):
    """Stone 1 lies in its slot; the only segment lies beside it, and no map shows stone 2."""
    database.set_state(1, done, 2.0)
    seen = database.stone(2).points_map.copy()
    place = database.stone(1).centroid_map + [0.0, beside_m, 0.0]
    seen += place - seen.mean(axis=0)
    part = Segment(0, seen, seen.mean(axis=0), np.ptp(seen, axis=0))
    offered = []
    observe = database.observe
    database.observe = lambda found, *rest: (offered.extend(found), observe(found, *rest))[1]
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(Segmenter, segment=Segmentation("map", (part,), *search.rest)),
    )
    search.tick(FindAgain, stone=2)
    assert [one.id for one in offered] == ([] if is_left_out else [0])


def test_a_segment_at_a_stone_on_the_ground_or_at_the_sought_one_itself_is_offered(
    stage, search, database
):
    database.set_state(1, StoneState.ON_GROUND, 2.0)
    database.set_state(2, StoneState.PLACED, 2.0)
    parts = tuple(
        Segment(i, stone.points_map, stone.centroid_map, np.ptp(stone.points_map, axis=0))
        for i, stone in enumerate(database.stones())
    )
    segmented = Segmentation("map", parts, *search.rest)
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(Segmenter, segment=segmented),
    )
    ended = search.tick(FindAgain, stone=2)
    assert ended.status == "SUCCESS"
    assert [event.seen for event in ended.events] == [(1, 2)]


def test_a_stone_that_is_gone_is_a_failure(stage, search, database):
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(Segmenter, segment=search.empty),
    )
    # The map shows most of it where it was, so it is there, whatever the segmentation makes of it.
    assert search.tick(FindAgain, stone=2).status == "SUCCESS"
    bare = plugins(search)["mapping"].points
    plugins(search)["mapping"] = stage.PointMap(bare[bare[:, 2] <= 0.0])
    ended = search.tick(FindAgain, stone=2)
    assert ended.status == "FAILURE"
    assert ended.reason == "stone 2 was not found within 4.0 m of its last place"
    sought = [event for event in ended.events if isinstance(event, StoneSoughtAgain)]
    assert [event.seen for event in sought] == [()]
    assert database.stone(2).state is StoneState.LOST
    plugins(search)["mapping"] = stage.PointMap([])
    ended = search.tick(FindAgain, stone=2)
    assert (ended.status, ended.reason) == ("FAILURE", "the map shows nothing around stone 2")


def test_nothing_is_sought_while_no_stone_is_lost(stage, search, database):
    registrar = stage.Scripted(Registrar)
    plugins(search)["registration"] = registrar
    assert search.tick(FindLost).status == "SUCCESS"
    assert registrar.asked == []


def test_a_lost_stone_keeps_its_identity_where_it_is_found(stage, search, database):
    """The stone fell 2.4 m away from its last place, farther than another stone may be."""
    database.set_state(2, StoneState.LOST, 5.0)
    fallen = stage.block((6.8, 1.4, 0.3), size=(0.8, 1.0, 0.6), seed=5)
    part = Segment(0, fallen, fallen.mean(axis=0), np.ones(3))
    plugins(search).update(
        registration=stage.Scripted(Registrar, find=alignment(False)),
        segmentation=stage.Scripted(
            Segmenter, segment=[search.empty, Segmentation("map", (part,), *search.rest)]
        ),
    )
    ended = search.tick(FindLost)
    assert (ended.status, ended.reason) == ("FAILURE", "stones [2] are lost")
    assert search.tick(FindLost).status == "SUCCESS"
    assert [stone.id for stone in database.stones()] == [1, 2]
    assert database.stone(2).state is StoneState.ON_GROUND
    assert database.stone(2).centroid_map[:2] == pytest.approx([6.8, 1.4], abs=0.1)


def test_no_grasp_is_planned_for_a_lost_stone(stage, search, database):
    database.set_state(2, StoneState.LOST, 5.0)
    plugins(search)["grasping"] = stage.Scripted(GraspPlanner)
    ended = search.tick(PlanGrasp, stone=2)
    assert (ended.status, "is lost" in ended.reason) == ("FAILURE", True)


def test_a_lost_stone_that_is_set_aside_stays_lost(world, database):
    database.release(1, world.hold.T_map_gripper, 5.0, StoneState.LOST)
    world.leaf_context.first_failure = lambda: "a slip"
    ended = world.tick(SetAside, stone=1)
    assert ended.status == "SUCCESS"
    assert ended.events[0].reason == "every attempt failed: first, a slip; last, no way there"
    assert database.stone(1).state is StoneState.LOST
