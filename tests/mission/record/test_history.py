"""The past of a mission that was cut off is given back to its tree in order, and compared."""

import pytest

from executive.errors import DataError
from executive.events.mission import WorldObserved
from executive.events.node import (
    LeafAnswered,
    LeafCalled,
    NodeStarted,
    QuestionAnswered,
)
from executive.events.stone import StoneLost
from executive.journal import Journal
from executive.mission.record.history import History, tree_entries

LEAF, CHECK = "main/0:swing", "main/1:calm"
OBSERVED = WorldObserved("GLOBAL", None, None, False, None, (), ())


class Values:
    """Values of a run's folder, which stand in the journal by their names."""

    def get(self, value):
        return f"value of {value}"


def history(*entries):
    """Return the history of entries, each with its tick (of 0.05 s), node and event."""
    journal = Journal()
    for tick, node, event in entries:
        journal.append(tick, tick * 0.05, node, event)
    return History(journal.newest, Values())


def answered(success=True, visit=0, **outputs):
    return LeafAnswered(success, "" if success else "no path", False, outputs, None, 0, visit)


def test_a_mission_that_was_cut_off_before_its_first_tick_has_no_past():
    past = history()
    assert past.is_over
    assert (past.last_tick, past.tick, past.time_s) == (0, 0, 0.0)
    past.follow(lambda: pytest.fail("there is nothing to follow"), every_tick=True)
    assert past.visit(LEAF, is_condition=False, number=0) is None
    assert past.answer_to(LEAF) is None


def test_only_what_the_tree_recorded_is_followed():
    entries = [
        (1, "main", NodeStarted()), (1, "", OBSERVED), (2, LEAF, StoneLost(1, "fell")),
        (3, "elsewhere", NodeStarted()), (4, LEAF, NodeStarted()),
    ]  # fmt: skip
    past = history(*entries)
    assert past.last_tick == 4
    past.tick = 1
    past.compare("main", NodeStarted())
    past.compare(LEAF, NodeStarted())
    assert past.is_over


def follow(past, **more):
    """Follow a history with a tree that records what it recorded; return ticks and times."""
    ticks = []

    def tick():
        ticks.append((past.tick, past.time_s))
        while not past.is_over and past._next.tick == past.tick:
            past.compare(past._next.node, past._next.event)

    past.follow(tick, **{"every_tick": False, **more})
    return ticks


STORY = [(2, "main", NodeStarted()), (2, LEAF, NodeStarted()), (5, CHECK, NodeStarted()),
         (7, LEAF, NodeStarted())]  # fmt: skip


def test_the_tree_is_ticked_where_it_recorded_something_up_to_the_last_tick():
    past = history(*STORY)
    assert follow(past) == [(2, 0.1), (5, 0.25)]
    assert past.tick == 7
    assert not past.is_over


def test_a_loop_that_counts_is_ticked_in_silent_ticks_too_at_times_between():
    ticks = follow(history(*STORY), every_tick=True)
    assert [tick for tick, _ in ticks] == [1, 2, 3, 4, 5]
    assert [time_s for _, time_s in ticks] == pytest.approx([0.05, 0.1, 0.15, 0.2, 0.25])


def test_a_tree_that_does_nothing_where_it_did_something_is_told_with_the_line():
    past = history(*STORY)
    told = r"cannot be followed at line 1: main node_started at 0\.1 s; now the tree does nothing"
    with pytest.raises(DataError, match=told):
        past.follow(lambda: None, every_tick=False)


@pytest.mark.parametrize(
    ("node", "event"), [(LEAF, NodeStarted()), ("main", StoneLost(1, "fell")),
                        ("main", LeafCalled({}))]
)  # fmt: skip
def test_a_tree_that_does_something_else_is_told(node, event):
    past = history(*STORY)
    with pytest.raises(DataError, match=f"now {node} records {event.kind}"):
        past.compare(node, event)


def test_an_event_with_other_values_is_something_else():
    past = history((1, LEAF, LeafCalled({"angle": 1})))
    with pytest.raises(DataError, match="'angle': 2"):
        past.compare(LEAF, LeafCalled({"angle": 2}))
    past.compare(LEAF, LeafCalled({"angle": 1}))
    with pytest.raises(DataError, match="after its end; now the mission records"):
        past.compare("", NodeStarted())


def test_a_leaf_answers_what_it_answered_with_its_outputs():
    past = history((1, LEAF, LeafCalled({})), (3, LEAF, answered(False, path="file 7")))
    past.tick = 1
    begun = past.visit(LEAF, is_condition=False, number=0)
    assert (begun.outcome, begun.has_begun) == (None, True)
    past.tick = 2
    waits = past.visit(LEAF, is_condition=False, number=0)
    assert (waits.outcome, waits.has_begun) == (None, False)
    past.tick = 3
    ended = past.visit(LEAF, is_condition=False, number=0)
    assert (ended.outcome.success, ended.outcome.reason) == (False, "no path")
    assert ended.written == {"path": "value of file 7"}
    assert past.is_over
    assert past.visit(LEAF, is_condition=False, number=0) is None


def test_a_leaf_that_had_just_begun_goes_on_in_the_present():
    past = history((1, LEAF, LeafCalled({})))
    past.tick = 1
    found = past.visit(LEAF, is_condition=False, number=0)
    assert (found.outcome, found.has_begun) == (None, True)
    assert past.is_over


def test_a_condition_answers_as_before_until_its_answer_changed():
    past = history((1, CHECK, answered(True, visit=1)), (2, CHECK, answered(False, visit=2)),
                   (9, LEAF, NodeStarted()))  # fmt: skip

    def asked(tick, number):
        past.tick = tick
        return past.visit(CHECK, is_condition=True, number=number).outcome.success

    answers = [asked(*at) for at in ((1, 1), (1, 2), (2, 1), (2, 2), (3, 1))]
    assert answers == [True, True, True, False, False]


def test_a_condition_that_was_never_asked_is_another_tree():
    past = history((1, LEAF, NodeStarted()))
    past.tick = 1
    with pytest.raises(DataError, match=f"now {CHECK} is asked"):
        past.visit(CHECK, is_condition=True, number=1)


def test_a_question_is_answered_in_the_tick_in_which_it_was():
    put = QuestionAnswered("Begin?", True, "operator")
    past = history((3, LEAF, put), (4, CHECK, NodeStarted()))
    for tick, node, answer in ((2, LEAF, None), (3, CHECK, None), (3, LEAF, put)):
        past.tick = tick
        assert past.answer_to(node) is answer
    past.compare(LEAF, put)
    past.tick = 4
    assert past.answer_to(CHECK) is None  # no question


def test_the_tick_in_which_a_run_was_cut_off_counts_to_that_in_which_it_was_resumed():
    journal = Journal()
    for tick, node, event in [
        (1, "main", NodeStarted()), (3, LEAF, NodeStarted()), (3, CHECK, NodeStarted()),
        (8, "", OBSERVED), (8, LEAF, NodeStarted()),
    ]:  # fmt: skip
        journal.append(tick, tick * 0.05, node, event)
    found = tree_entries(journal.newest)
    assert [entry.tick for entry in found] == [1, 8, 8, 8]
    assert [entry.time_s for entry in found] == pytest.approx([0.05, 0.4, 0.4, 0.4])
