"""What PlanPick learns from its attempts: those that failed, and what came of each."""

from types import SimpleNamespace

import pytest

from executive.behaviours.plan_pick import PlanPick, _Tried
from executive.messages.stone import StoneState


def leaf(tried, *history):
    """A leaf after attempts (start, grasp, rate) by stone; stone 7 has a history."""
    events = [SimpleNamespace(stamp_s=stamp_s, state=state) for stamp_s, state in history]
    database = SimpleNamespace(history=lambda stone: events if stone == 7 else [])
    one = PlanPick.__new__(PlanPick)
    one.context = SimpleNamespace(use=lambda interface: database)
    one._tried = {stone: [_Tried(*attempt) for attempt in many] for stone, many in tried.items()}
    return one


def failed(one, stone=7):
    return one._failed(SimpleNamespace(id=stone))


def test_all_that_was_tried_has_failed_while_the_stone_was_never_placed():
    one = leaf({7: [(10.0, "a", 0.5), (20.0, "b", 0.6)]}, (15.0, StoneState.HELD))
    assert failed(one) == ["a", "b"]
    assert one._past() == [(0.5, False), (0.6, False)]


@pytest.mark.parametrize(("placed_s", "left"), [(9.0, ["a", "b"]), (10.0, ["b"]), (20.0, [])])
def test_what_was_tried_until_a_stone_was_last_placed_has_not_failed(placed_s, left):
    one = leaf(
        {7: [(10.0, "a", 0.5), (20.0, "b", 0.6)], 8: [(1.0, "c", 0.7)]},
        (5.0, StoneState.PLACED), (placed_s, StoneState.PLACED), (30.0, StoneState.HELD),
    )  # fmt: skip
    assert failed(one) == left
    assert failed(one, 8) == ["c"]


@pytest.mark.parametrize(
    ("placed_s", "came"),
    [
        (9.0, [False, False]),
        (10.0, [False, False]),
        (10.1, [True, False]),
        (20.0, [True, False]),
        (20.1, [False, True]),
        (900.0, [False, True]),
    ],
)
def test_an_attempt_led_to_a_place_if_the_stone_got_there_before_the_next_one(placed_s, came):
    one = leaf({7: [(10.0, "a", 0.5), (20.0, "b", 0.6)]}, (placed_s, StoneState.PLACED))
    assert one._past() == [(0.5, came[0]), (0.6, came[1])]


def test_a_grasp_that_nobody_lifted_teaches_nothing():
    one = leaf({7: [(10.0, "a", None), (20.0, "b", 0.6)]}, (25.0, StoneState.PLACED))
    assert one._past() == [(0.6, True)]


def test_of_a_stone_that_was_not_tried_nothing_has_failed():
    assert failed(leaf({}), 9) == []
    assert leaf({})._past() == []
