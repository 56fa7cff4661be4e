"""A stone that was set aside is tried again once others have moved, and not before."""

import numpy as np
import pytest
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.behaviours.take_up_again import TakeUpAgain
from executive.config import NoSettings
from executive.messages.segment import Segment
from executive.messages.stone import StoneState


@pytest.fixture
def objects():
    database = SqliteObjects(SqliteObjectsSettings())
    database.open(":memory:")
    points = np.random.default_rng(0).uniform(-0.4, 0.4, (200, 3))
    segments = [
        Segment(i, points + [4.0 * i, 0, 0], np.array([4.0 * i, 0, 0]), np.ones(3))
        for i in range(3)
    ]
    database.observe(segments, 0.0, True)
    yield database
    database.close()


def set_aside(objects, stone, stamp_s):
    objects.set_state(stone, StoneState.SET_ASIDE, stamp_s)


def place(objects, stone, stamp_s):
    objects.grasp(stone, np.eye(4), stamp_s - 1)
    objects.release(stone, np.eye(4), stamp_s, StoneState.PLACED)


def test_what_was_set_aside_before_another_was_placed_is_taken_up(objects, fakes):
    set_aside(objects, 1, 10.0)
    place(objects, 2, 20.0)
    set_aside(objects, 3, 30.0)
    context = fakes.Context(objects=objects)
    assert TakeUpAgain(NoSettings(), context).check().success
    assert [s.state for s in objects.stones()] == [
        StoneState.ON_GROUND,
        StoneState.PLACED,
        StoneState.SET_ASIDE,
    ]
    assert context.notes == [("stones_taken_up_again", {"stones": [1]})]


def test_what_happens_to_a_stone_after_it_was_set_aside_does_not_hide_since_when(objects, fakes):
    set_aside(objects, 1, 10.0)
    place(objects, 2, 20.0)
    objects.realign(1, np.eye(4), 25.0)
    assert TakeUpAgain(NoSettings(), fakes.Context(objects=objects)).check().success


def test_where_nothing_has_moved_since_another_try_is_no_use(objects, fakes):
    place(objects, 2, 5.0)
    objects.realign(2, np.eye(4), 15.0)  # seen anew, not moved
    set_aside(objects, 1, 10.0)
    outcome = TakeUpAgain(NoSettings(), fakes.Context(objects=objects)).check()
    assert not outcome.success
    assert objects.stone(1).state is StoneState.SET_ASIDE


def test_a_stone_that_no_attempt_can_move_is_left(objects, fakes):
    set_aside(objects, 1, 10.0)
    place(objects, 2, 20.0)
    context = fakes.Context(objects=objects)
    context.given_up = frozenset({1})
    assert not TakeUpAgain(NoSettings(), context).check().success
