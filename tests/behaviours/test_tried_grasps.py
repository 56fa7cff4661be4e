"""Which grasps of a stone PlanPick counts as failed: those tried since it was last placed."""

from types import SimpleNamespace

import pytest

from executive.behaviours.plan_pick import PlanPick
from executive.messages.stone import StoneState


def leaf(tried, *history):
    events = [SimpleNamespace(stamp_s=stamp_s, state=state) for stamp_s, state in history]
    database = SimpleNamespace(history=lambda stone: events if stone == 7 else [])
    return SimpleNamespace(_tried=tried, context=SimpleNamespace(use=lambda interface: database))


def failed(one, stone=7):
    return PlanPick._failed(one, SimpleNamespace(id=stone))


def test_all_that_was_tried_has_failed_while_the_stone_was_never_placed():
    one = leaf({7: [(10.0, "a"), (20.0, "b")]}, (15.0, StoneState.HELD))
    assert failed(one) == ["a", "b"]


@pytest.mark.parametrize(("placed_s", "left"), [(9.0, ["a", "b"]), (10.0, ["b"]), (20.0, [])])
def test_what_was_tried_until_a_stone_was_last_placed_is_forgotten(placed_s, left):
    one = leaf(
        {7: [(10.0, "a"), (20.0, "b")], 8: [(1.0, "c")]},
        (5.0, StoneState.PLACED), (placed_s, StoneState.PLACED), (30.0, StoneState.HELD),
    )  # fmt: skip
    assert failed(one) == left
    assert [grasp for _, grasp in one._tried[7]] == left
    assert one._tried[8] == [(1.0, "c")]


def test_of_a_stone_that_was_not_tried_nothing_has_failed():
    assert failed(leaf({}), 9) == []
