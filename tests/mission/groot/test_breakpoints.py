"""Breakpoints of nodes that a test ticks itself: where the tree waits, and what lets it go on."""

from typing import Any

import pytest
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.mission.groot.breakpoints import AFTER, BEFORE, Breakpoints
from executive.mission.groot.protocol import GrootError
from executive.mission.wishes import Wishes


class Node(Behaviour):
    """Succeeds at each tick, and counts them."""

    def __init__(self, path: str) -> None:
        super().__init__(path)
        self.path, self.ticks = path, 0
        self.is_under_way = False  # nothing of it runs between two ticks

    def update(self) -> Status:
        self.ticks += 1
        return Status.SUCCESS


class Stand:
    def __init__(self) -> None:
        self.nodes = {1: Node("main/0"), 2: Node("main/1")}
        self.wishes, self.reached = Wishes(), []
        self.points = Breakpoints(self.nodes.get, self.wishes, self.reached.append)

    def tick(self, uid: int = 1) -> Status:
        self.nodes[uid].tick_once()
        return self.nodes[uid].status


@pytest.fixture
def stand() -> Stand:
    return Stand()


def at(uid: int = 1, position: int = BEFORE, **more: Any) -> dict[str, Any]:
    return {"uid": uid, "position": position, **more}


def test_a_breakpoint_is_on_and_lasts_unless_it_is_said_otherwise(stand: Stand) -> None:
    stand.points.insert(at())
    stand.points.insert(at(2, AFTER, enabled=False, once=True, mode=0))
    assert stand.points.as_json() == [
        {
            "enabled": True,
            "uid": 1,
            "mode": 0,
            "once": False,
            "desired_status": "SKIPPED",
            "position": BEFORE,
        },
        {
            "enabled": False,
            "uid": 2,
            "mode": 0,
            "once": True,
            "desired_status": "SKIPPED",
            "position": AFTER,
        },
    ]
    assert list(stand.points.told) == [
        ("breakpoint", "before main/0"),
        ("breakpoint", "after main/1"),
    ]
    assert stand.tick(2) is Status.SUCCESS
    assert stand.reached == []


def test_the_tree_waits_before_a_node_until_it_is_let_go_and_again_the_next_time(
    stand: Stand,
) -> None:
    stand.points.insert(at())
    for number in (1, 2):
        assert stand.tick() is Status.RUNNING
        assert stand.wishes.pause == "breakpoint before main/0"
        assert stand.reached == number * [1]
        stand.points.unlock(at())
        assert stand.wishes.pause == ""
        assert stand.tick() is Status.SUCCESS
        assert stand.nodes[1].ticks == number


def test_after_a_node_the_tree_waits_with_its_result(stand: Stand) -> None:
    stand.points.insert(at(position=AFTER, once=True))
    assert stand.tick() is Status.RUNNING
    assert (stand.nodes[1].ticks, stand.wishes.pause) == (1, "breakpoint after main/0")
    stand.points.unlock(at(position=AFTER))
    assert stand.tick() is Status.SUCCESS
    assert stand.nodes[1].ticks == 1
    assert stand.points.as_json() == []  # it was wanted once
    assert stand.tick() is Status.SUCCESS
    assert stand.nodes[1].ticks == 2


def test_the_last_of_two_that_hold_lets_the_tree_go_on(stand: Stand) -> None:
    for uid in (1, 2):
        stand.points.insert(at(uid))
        stand.tick(uid)
    stand.points.unlock(at(1))
    assert stand.wishes.pause == "breakpoint before main/1"
    stand.points.remove(at(2))
    assert (stand.wishes.pause, stand.wishes.resumed) == ("", "resumed by a Groot2 client")


def test_a_pause_that_a_person_wants_outlasts_the_breakpoints(stand: Stand) -> None:
    stand.points.insert(at())
    stand.tick()
    stand.wishes.hold("paused by the operator")
    stand.points.remove_all()
    assert stand.wishes.pause == "paused by the operator"
    assert list(stand.points.told)[-1] == ("no breakpoint", "before main/0")


def test_one_that_is_turned_off_lets_go_and_can_be_turned_on_again(stand: Stand) -> None:
    stand.points.insert(at())
    stand.tick()
    stand.points.disable_all()
    assert stand.wishes.pause == ""
    assert stand.tick() is Status.SUCCESS
    assert stand.tick() is Status.SUCCESS
    stand.points.insert(at())
    assert stand.tick() is Status.RUNNING


@pytest.mark.parametrize("do", ["remove", "unlock"])
def test_what_is_not_there_is_refused(stand: Stand, do: str) -> None:
    stand.points.insert(at())
    with pytest.raises(GrootError, match="Node ID not found"):
        getattr(stand.points, do)(at(position=AFTER))
    with pytest.raises(GrootError, match="Node ID not found"):
        stand.points.insert(at(3))
    with pytest.raises(GrootError, match="cannot be replaced by a result"):
        stand.points.insert(at(2, mode=1))
    stand.tick()
    with pytest.raises(GrootError, match="only an action that has not begun"):
        stand.points.unlock(at(desired_status="SUCCESS"))
    assert stand.wishes.pause
