"""What leaves answer is written as events, and given back when their mission is resumed."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from executive.errors import DataError
from executive.events.node import (
    LeafAnswered,
    LeafCalled,
    NodeStarted,
    QuestionAnswered,
)
from executive.events.stone import StoneLost
from executive.journal import Journal
from executive.journal.value_folder import ValueFolder
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.mission.record.history import History
from executive.mission.record.leaf_memory import LeafMemory, shown

LEAF, CHECK = "main/0:swing", "main/1:calm"


class Kept:
    """A memory, what it records, and how often it waited for the disk."""

    def __init__(self, folder):
        self.events, self.secured = [], 0
        self.values = ValueFolder(folder)
        self.memory = LeafMemory(self.values, self._secure)
        self.memory.bind(lambda node, event: self.events.append((node, event)))

    def _secure(self):
        self.secured += 1

    def follow(self, *entries):
        """Give the memory a past of entries: tick, node, event."""
        journal = Journal()
        for tick, node, event in entries:
            journal.append(tick, tick * 0.1, node, event)
        self.memory.history = History(journal.newest, self.values)

    def told(self):
        return [(node, event.kind, event.payload()) for node, event in self.events]

    def ask(self, success=True, reason="", node=CHECK):
        """Visit a condition that answers."""
        assert self.memory.recall(node, is_condition=True) is None
        outcome = succeeded(reason=reason) if success else failed(reason)
        self.memory.answered(node, outcome, {}, {}, is_condition=True)


@pytest.fixture
def kept(tmp_path):
    return Kept(tmp_path / "values")


def answered(node=CHECK, *, success=True, reason="", **more):
    given = {"is_final": False, "outputs": {}, "state": None, "draws": 0, "visit": 0} | more
    return node, "leaf_answered", {"success": success, "reason": reason, **given}


def test_a_call_is_kept_with_its_inputs_and_an_irreversible_one_on_the_disk(kept):
    stone = SimpleNamespace(id=4)
    kept.memory.called(LEAF, {"angle": 0.5, "stone": stone}, is_irreversible=False)
    assert kept.secured == 0
    kept.memory.called(LEAF, {}, is_irreversible=True)
    assert kept.secured == 1
    kept.memory.taken_up(LEAF, OnResume.REDO)
    shown_stone = {"class": "SimpleNamespace", "id": 4}
    assert kept.told() == [
        (LEAF, "leaf_called", {"inputs": {"angle": 0.5, "stone": shown_stone}}),
        (LEAF, "leaf_called", {"inputs": {}}),
        (LEAF, "leaf_taken_up", {"policy": "redo"}),
    ]  # fmt: skip


def test_each_answer_of_an_action_is_kept_whole(kept):
    kept.memory.watch(LEAF, SimpleNamespace(draws=3))
    written, state = {"mass": 4.5, "path": np.arange(3.0)}, {"rounds": 2}
    assert not kept.memory.has_answered
    for _ in range(2):
        kept.memory.answered(
            LEAF, failed("too heavy", is_final=True), written, state, is_condition=False
        )
    assert kept.memory.has_answered
    first, second = (event for _, event in kept.events)
    assert first.payload() == second.payload()
    assert (first.success, first.reason, first.is_final) == (False, "too heavy", True)
    assert (first.draws, first.visit) == (3, 0)
    assert first.outputs["mass"] == 4.5
    np.testing.assert_array_equal(kept.values.get(first.outputs["path"]), [0.0, 1.0, 2.0])
    assert kept.values.get(first.state) == {"rounds": 2}


def test_an_answer_of_a_condition_is_kept_where_it_differs_from_the_one_before(kept):
    kept.memory.begin_tick(1)
    kept.ask(True)
    kept.ask(True)  # in the same tick
    kept.ask(True, node=LEAF)
    kept.memory.begin_tick(2)
    kept.ask(True)
    kept.ask(False, "moves")
    kept.memory.begin_tick(2)  # the same tick: visits are counted on
    kept.ask(False, "moves fast")
    assert kept.told() == [
        answered(visit=1),
        answered(LEAF, visit=1),
        answered(success=False, reason="moves", visit=2),
        answered(success=False, reason="moves fast", visit=3),
    ]


def test_without_a_past_nothing_is_recalled_and_a_question_is_put(kept):
    memory = kept.memory
    assert not memory.is_past
    assert memory.failure is None
    assert memory.recall(LEAF, is_condition=False) is None
    assert memory.took("main", NodeStarted()) is False
    assert memory.question(LEAF, lambda: "a question") == "a question"


def test_the_past_takes_what_the_tree_records_and_nothing_else(kept):
    kept.follow((1, "main", NodeStarted()), (1, LEAF, NodeStarted()))
    memory = kept.memory
    assert memory.is_past
    assert not memory.took(LEAF, StoneLost(1, "fell"))  # of the leaf
    assert memory.took("main", NodeStarted())
    with pytest.raises(DataError, match="now main records leaf_called"):
        memory.took("main", LeafCalled({}))
    assert memory.took(LEAF, NodeStarted())
    assert not memory.is_past
    assert not memory.took("main", NodeStarted())


def test_leaves_take_back_their_state_and_draws_before_the_first_of_them_is_asked(kept):
    state = kept.values.put({"rounds": 2})
    kept.follow(
        (1, LEAF, LeafAnswered(True, "", state=state, draws=5)),
        (2, CHECK, LeafAnswered(True, "", visit=1)),
        (2, "main/2", LeafAnswered(True, "", visit=1)),
        (3, LEAF, NodeStarted()),
    )
    memory, restored, draws = kept.memory, [], SimpleNamespace(draws=0)
    memory.attach(LEAF, restored.append)
    memory.attach(CHECK, restored.append)  # keeps no state
    memory.watch(LEAF, draws)
    history = memory.history
    history.tick = 1
    assert memory.recall(LEAF, is_condition=False).outcome == succeeded()
    history.tick = 2
    memory.begin_tick(2)
    assert memory.recall(CHECK, is_condition=True).outcome == succeeded()
    assert memory.recall("main/2", is_condition=True).outcome == succeeded()
    memory.took(LEAF, NodeStarted())
    assert (restored, draws.draws) == ([], 0)
    memory.begin_tick(3)
    draws.draws = 1
    for _ in range(2):  # once only
        assert memory.recall(CHECK, is_condition=True) is None
    assert (restored, draws.draws) == ([{"rounds": 2}], 5)
    kept.memory.answered(CHECK, succeeded(), {}, {}, is_condition=True)
    assert kept.events == []  # it answered so in the past
    kept.memory.answered(CHECK, failed("moves"), {}, {}, is_condition=True)
    assert kept.told() == [answered(success=False, reason="moves", visit=2)]


def test_a_visit_of_a_condition_is_recalled_by_its_number_in_the_tick(kept):
    kept.follow(
        (1, CHECK, LeafAnswered(True, "", visit=1)),
        (1, CHECK, LeafAnswered(False, "moves", visit=3)),
        (9, LEAF, NodeStarted()),
    )
    memory = kept.memory
    memory.history.tick = 1
    memory.begin_tick(1)
    found = [memory.recall(CHECK, is_condition=True).outcome.success for _ in range(4)]
    assert found == [True, True, False, False]


class Question:
    """A question of the present."""

    def answer(self):
        return "now"

    def source(self):
        return "operator of today"


def test_a_question_of_the_past_is_answered_as_it_was(kept):
    put = QuestionAnswered("Begin?", True, "option")
    kept.follow((3, LEAF, put), (5, "main", NodeStarted()))
    asked = []
    question = kept.memory.question(LEAF, lambda: asked.append(1) or Question())
    kept.memory.history.tick = 2
    assert (question.answer(), question.source()) == (None, "")
    kept.memory.history.tick = 3
    assert (question.answer(), question.source(), asked) == (True, "option", [])


def test_a_question_that_was_open_is_put_once_when_the_present_begins(kept):
    kept.follow((3, "main", NodeStarted()))
    asked = []
    question = kept.memory.question(LEAF, lambda: asked.append(1) or Question())
    assert (question.answer(), asked) == (None, [])
    kept.memory.took("main", NodeStarted())
    answers = [question.answer() for _ in range(2)]
    assert (answers, question.source(), asked) == (["now", "now"], "operator of today", [1])


@dataclass
class Pick:
    id: int
    stone_id: int


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, None),
        (True, True),
        (2.5, 2.5),
        ("a", "a"),
        (OnResume.ASK, "ask"),
        ((1, [2, None]), [1, [2, None]]),
        (list(range(8)), list(range(8))),
        (list(range(9)), [*range(8), "… 9 in all"]),
        (np.zeros(3), {"class": "ndarray"}),
        (Pick(np.int64(3), 7), {"class": "Pick", "id": 3, "stone_id": 7}),
    ],
)  # fmt: skip
def test_a_person_is_shown_small_values_and_the_class_of_large_ones(value, expected):
    assert shown(value) == expected
