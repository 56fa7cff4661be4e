"""SeeUnderside, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours import see_underside
from executive.behaviours.see_underside import SeeUnderside
from executive.events.stone import StoneSeenFromBelow
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between
from executive.leaf.surroundings import held_surface
from executive.machine.kinematics import Kinematics
from executive.messages.command import SwitchLidars
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from tests.behaviours.placing.scene import NO_PATH, NO_WAY, plugins


@pytest.fixture
def world(world):
    """A stage on which a way leads to where the arm is, and the stone has an underside."""
    names = world.leaf_context.machine().arm_names
    stay = np.stack([world.leaf_context.arm()] * 2)
    path = JointTrajectory(names, np.array([0.0, 1.0]), stay, np.zeros_like(stay))
    world.way = MotionPlan(path, "", NO_PATH)
    plugins(world)["motion"].answers(move=world.way, reach=stay[0])
    return world


def underside(world, share=1.0):
    """Return returns of an underside 0.1 m above the lowest point of the model, as it hangs."""
    stone = plugins(world)["objects"].stone(1)
    low, high = stone.points_map.min(axis=0), stone.points_map.max(axis=0)
    spots = np.random.default_rng(0).uniform(low, high, (8000, 3))
    spots = spots[spots[:, 0] < low[0] + share * (high - low)[0]]
    spots[:, 2] = low[2] + 0.1
    return transform(inverse(world.hold.T_map_gripper), spots)


def lidars(world):
    sent = [one["command"] for one in plugins(world)["robot"].calls("command")]
    return [one.on for one in sent if isinstance(one, SwitchLidars)]


def test_what_is_seen_from_below_becomes_the_lower_half_of_the_model(world, database):
    before = database.stone(1)
    plugins(world)["mapping"].seen = underside(world)
    ended = world.tick(SeeUnderside, hold=world.hold)
    assert ended.status == "SUCCESS", ended.reason
    assert ended.outputs == {"underside_is_new": True}
    assert lidars(world) == [True, False]
    after = database.stone(1)
    np.testing.assert_array_equal(after.T_map_object, before.T_map_object)
    lowest_m = [one.points_map[:, 2].min() for one in (before, after)]
    assert lowest_m[1] - lowest_m[0] == pytest.approx(0.1, abs=0.03)
    (event,) = ended.events
    assert isinstance(event, StoneSeenFromBelow)
    assert event.accepted
    assert event.seen > 0.6
    assert event.raised_m == pytest.approx(0.1, abs=0.03)
    assert [one.kind for one in database.history(1)][-1] == "reshaped"
    # It is not raised once more: what was planned since was planned on what was seen.
    again = world.tick(SeeUnderside, hold=world.hold)
    assert (again.status, again.outputs) == ("SUCCESS", {"underside_is_new": False})
    assert again.reason == "the underside of stone 1 is known"
    assert lidars(world) == [True, False]


def test_it_is_raised_to_the_nearest_place_from_which_its_foot_is_seen_as_is_wanted(world):
    world.tick(SeeUnderside, hold=world.hold)
    context = world.leaf_context
    (asked,) = plugins(world)["motion"].calls("move")
    T_base_map = inverse(context.state().T_map_base)
    start, goal = (T_base_map @ T for T in (context.gripper(), asked["request"].T_map_gripper))
    assert goal[2, 3] > start[2, 3]
    assert np.hypot(*goal[:2, 3]) <= np.hypot(*start[:2, 3]) + 1e-9
    assert angle_between(start[:3, :3], goal[:3, :3]) == pytest.approx(2.6)
    frames = Kinematics(context.machine()).frames(context.arm())
    lidar = max((frames[one.name][:3, 3] for one in context.machine().sensors_of("lidar")),
                key=lambda place: place[2])  # fmt: skip
    foot_m = goal[2, 3] + (held_surface(context, world.hold) @ start[2, :3]).min()
    away_m = np.hypot(*goal[:2, 3]) - np.hypot(*lidar[:2])
    assert np.arctan2(foot_m - lidar[2], away_m) >= 0.7


def test_a_lower_place_is_taken_where_no_way_leads_higher(world, stage):
    asked = []

    def move(request):
        asked.append(request.T_map_gripper[2, 3])
        return world.way if len(asked) == 3 else NO_WAY

    plugins(world)["motion"].answers(move=move)
    ended = world.tick(SeeUnderside, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert len(asked) == 3
    assert lidars(world) == [True, False]


def test_a_stone_of_which_too_little_is_seen_keeps_its_model(world, database):
    before = database.stone(1)
    plugins(world)["mapping"].seen = underside(world, share=0.3)
    ended = world.tick(SeeUnderside, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.outputs == {"underside_is_new": False}
    np.testing.assert_array_equal(database.stone(1).points_map, before.points_map)
    (event,) = ended.events
    assert not event.accepted
    assert 0.0 < event.seen < 0.5


@pytest.mark.parametrize("why", ["no way", "too heavy", "too low", "out of reach", "no lidar"])
def test_a_stone_that_cannot_be_raised_is_not_looked_at(world, monkeypatch, why):
    settings, told = {}, "the boom would hit stone 2"
    if why == "no way":
        plugins(world)["motion"].answers(move=NO_WAY)
    elif why == "too heavy":
        told = "1.2 t are too heavy 6 m away"
        monkeypatch.setattr(see_underside, "too_heavy", lambda *rest: told)
    elif why == "no lidar":
        told, machine = "the machine has no lidar", world.leaf_context.machine()
        sensors = {name: one for name, one in machine.sensors.items() if one.kind != "lidar"}
        blind = machine.model_copy(update={"sensors": sensors})
        monkeypatch.setattr(world.leaf_context, "machine", lambda: blind)
    elif why == "out of reach":
        told = "no place from which its foot would be seen is in reach"
        plugins(world)["motion"].answers(reach=None)
    else:
        settings, told = {"least_angle": 1.5}, "no place from which its foot would be seen"
    ended = world.tick(SeeUnderside, settings=settings, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.reason.startswith("stone 1 was not seen from below: ")
    assert told in ended.reason
    assert ended.outputs == {"underside_is_new": False}
    assert (ended.events, lidars(world)) == ([], [])


def test_a_raise_that_does_not_come_to_its_end_is_a_failure(world):
    off = world.way.trajectory.position + 0.5
    path = JointTrajectory(
        world.way.trajectory.names, np.array([0.0, 1.0]), off, np.zeros_like(off)
    )
    plugins(world)["motion"].answers(move=MotionPlan(path, "", pose()[:0, :3]))
    ended = world.tick(SeeUnderside, hold=world.hold)
    assert ended.status == "FAILURE"
    assert "plan again" in ended.reason
    assert lidars(world) == [True, False]
