"""VerifyPlacement, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.verify_placement import VerifyPlacement
from executive.events.stone import PlacementVerified, StoneLost
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.messages.segment import Segment
from executive.messages.stone import StoneState
from tests.behaviours.placing.scene import set_down


def tilted(database, angle_rad):
    """Return the motion in the map that tips stone 1 over its centre."""
    centre = pose(t=database.stone(1).centroid_map)
    return centre @ pose(from_rpy(angle_rad, 0.0, 0.0)) @ inverse(centre)


def verified(ended):
    (event,) = (one for one in ended.events if isinstance(one, PlacementVerified))
    return event


def test_a_stone_that_is_seen_at_its_place_is_placed(world, database):
    planned = set_down(world, database, realigned=pose(t=np.array([0.05, 0.0, 0.0])))
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert ended.status == "SUCCESS"
    assert (verified(ended).seen, verified(ended).off_m) == ("placed", pytest.approx(0.05))
    assert verified(ended).turn_known
    assert database.stone(1).state is StoneState.PLACED


@pytest.mark.parametrize(
    ("rule", "status", "state"),
    [
        ("correct", "FAILURE", StoneState.ON_GROUND),
        ("keep", "SUCCESS", StoneState.PLACED),
        ("set_aside", "SUCCESS", StoneState.SET_ASIDE),
    ],
)
def test_a_stone_that_stands_off_its_place_is_treated_by_the_missions_rule(
    world, database, rule, status, state
):
    planned = set_down(world, database, realigned=pose(t=np.array([0.36, 0.0, 0.0])))
    ended = world.tick(VerifyPlacement, settings={"otherwise": rule}, stone=1, placement=planned)
    assert ended.status == status
    assert "stone 1 is 0.36 m off its place" in ended.reason
    assert (verified(ended).seen, verified(ended).rule) == ("off", rule)
    assert database.stone(1).state is state


def test_a_stone_that_toppled_on_its_place_is_off(world, database):
    planned = set_down(world, database, realigned=tilted(database, np.radians(88)))
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, "tilted by 88°" in ended.reason) == ("FAILURE", True)


def test_a_stone_that_turned_about_the_vertical_is_placed(world, database):
    centre = pose(t=database.stone(1).centroid_map)
    turn = centre @ pose(from_rpy(0.0, 0.0, 1.0)) @ inverse(centre)
    planned = set_down(world, database, realigned=turn)
    assert world.tick(VerifyPlacement, stone=1, placement=planned).status == "SUCCESS"


@pytest.mark.parametrize(
    ("rule", "status"), [("correct", "FAILURE"), ("keep", "SUCCESS"), ("set_aside", "SUCCESS")]
)
def test_a_stone_that_was_not_seen_is_lost_by_each_rule(world, database, rule, status):
    planned = set_down(world, database)
    ended = world.tick(VerifyPlacement, settings={"otherwise": rule}, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen, verified(ended).rule) == (status, "unseen", rule)
    assert "not seen where it was set down" in ended.reason
    assert [event.stone for event in ended.events if isinstance(event, StoneLost)] == [1]
    assert database.stone(1).state is StoneState.LOST


def test_a_lost_stone_that_a_second_look_shows_at_its_place_is_placed(world, database):
    planned = set_down(world, database)
    database.set_state(1, StoneState.LOST, 6.0)
    database.realign(1, pose(t=np.array([0.05, 0.0, 0.0])), 7.0, "registration")
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen) == ("SUCCESS", "placed")
    assert database.stone(1).state is StoneState.PLACED


def test_a_stone_seen_there_with_another_surface_has_turned(stage, world, database):
    planned = set_down(world, database)
    flat = stage.block(database.stone(1).centroid_map, size=(0.9, 0.3, 1.1), seed=4)
    database.observe([Segment(0, flat, flat.mean(axis=0), np.ones(3))], 6.0, False)
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen) == ("FAILURE", "off")
    assert "it has turned" in ended.reason
    assert not verified(ended).turn_known


def test_a_stone_that_had_turned_over_is_placed_by_its_new_surface_and_that_is_told(
    stage, world, database
):
    database.release(1, world.hold.T_map_gripper, 3.0, StoneState.ON_GROUND)
    flat = stage.block(database.stone(1).centroid_map, size=(0.9, 0.3, 1.1), seed=4)
    database.observe([Segment(0, flat, flat.mean(axis=0), np.ones(3))], 4.0, False)
    database.grasp(1, world.hold.T_map_gripper, 4.5)
    planned = set_down(world, database, realigned=pose(t=np.array([0.05, 0.0, 0.0])))
    ended = world.tick(VerifyPlacement, stone=1, placement=planned)
    assert (ended.status, verified(ended).seen) == ("SUCCESS", "placed")
    assert not verified(ended).turn_known
    assert "by a surface that is not the one it was found with" in ended.reason
