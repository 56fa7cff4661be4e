"""Leaves are followed through the past of a resumed mission, and kept in its present."""

from typing import Any

import pytest

from executive.leaf.action import Action, Condition, Steps
from executive.leaf.memory import Memory, OnResume, Recalled
from executive.leaf.outcome import Outcome, failed, succeeded


class Past(Memory):
    """Gives back what leaves answered, visit by visit, and keeps what they answer then."""

    def __init__(self, *visits: Recalled) -> None:
        self.visits, self.told, self.restore = list(visits), [], {}

    def recall(self, node: str, *, is_condition: bool) -> Recalled | None:
        self.told.append(("visit", node, is_condition))
        return self.visits.pop(0) if self.visits else None

    def called(self, node: str, inputs: Any, *, is_irreversible: bool) -> None:
        self.told.append(("called", node, dict(inputs), is_irreversible))

    def taken_up(self, node: str, policy: OnResume) -> None:
        self.told.append(("taken up", node, policy))

    def answered(
        self, node: str, outcome: Outcome, written: Any, state: Any, *, is_condition: bool
    ) -> None:
        self.told.append(
            ("answered", node, outcome.success, outcome.reason, dict(written), dict(state),
             is_condition)
        )  # fmt: skip

    def attach(self, node: str, restore: Any) -> None:
        self.restore[node] = restore


class Count(Action):
    """Counts its calls; takes one tick."""

    on_resume = OnResume.REDO
    is_irreversible = True

    def __init__(self, settings: Any, context: Any) -> None:
        super().__init__(settings, context)
        self.calls = 0

    def run(self, least: int) -> Steps[None]:
        self.calls += 1
        yield None
        return succeeded(reason=f"call {self.calls} from {least}")


class Even(Condition):
    """Answers by a number."""

    def check(self, number: int) -> Outcome[None]:
        return succeeded() if number % 2 == 0 else failed("odd")


LEAVES = {"Count": Count, "Even": Even}
COUNT = "sequence:\n  - set: {least: 3}\n  - run: Count"
PATH, CHECK = "main/1:Count", "main/1:Even"


@pytest.fixture
def follow(play: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Build a tree whose leaves have a memory of so many visits."""

    def follow(main: str, *visits: Recalled) -> tuple[Any, Past]:
        past = Past(*visits)
        monkeypatch.setattr("executive.leaf.runtime.Runtime.memory", past)
        return play(main, leaves=LEAVES), past

    return follow


def test_a_leaf_that_is_called_now_is_kept_with_its_inputs_answer_and_state(follow: Any) -> None:
    tree, past = follow(COUNT)
    assert tree.finish() == "SUCCESS"
    assert past.told == [
        ("visit", PATH, False),
        ("called", PATH, {"least": 3}, True),
        ("visit", PATH, False),
        ("answered", PATH, True, "call 1 from 3", {}, {"calls": 1}, False),
    ]


def test_a_leaf_of_the_past_answers_as_it_did_and_is_not_called(follow: Any) -> None:
    tree, past = follow(
        COUNT,
        Recalled(None, {}, has_begun=True),
        Recalled(None, {}, has_begun=False),
        Recalled(Outcome(False, "no"), {}, has_begun=False),
    )
    assert [tree.tick() for _ in range(3)] == ["RUNNING", "RUNNING", "FAILURE"]
    assert tree.reason == "no"
    assert [kind for kind, *_ in past.told] == ["visit"] * 3


def test_a_leaf_that_was_under_way_at_the_end_of_the_past_is_taken_up_with_its_inputs(
    follow: Any,
) -> None:
    tree, past = follow(COUNT, Recalled(None, {}, has_begun=True))
    tree.tick()
    tree.runtime.store.set("least", 9)  # changed since: the call goes on with what it was given
    assert tree.finish() == "SUCCESS"
    assert past.told[1:] == [
        ("visit", PATH, False),
        ("taken up", PATH, OnResume.REDO),
        ("visit", PATH, False),
        ("answered", PATH, True, "call 1 from 3", {}, {"calls": 1}, False),
    ]


def test_a_leaf_that_ended_in_the_past_is_called_anew_in_the_next_round(follow: Any) -> None:
    main = "sequence:\n  - set: {least: 3}\n  - loop: {max: 2}\n    do: {run: Count}"
    tree, past = follow(
        main,
        Recalled(None, {}, has_begun=True),
        Recalled(Outcome(True, "then"), {}, has_begun=False),
    )
    assert tree.finish() == "SUCCESS"
    assert [kind for kind, *_ in past.told].count("called") == 1
    assert "taken up" not in [kind for kind, *_ in past.told]


def test_a_leaf_takes_its_state_back(follow: Any) -> None:
    tree, past = follow(COUNT)
    past.restore[PATH]({"calls": 7})
    tree.finish()
    assert past.told[-1][3] == "call 8 from 3"


def test_a_condition_is_followed_and_kept_as_a_condition(follow: Any) -> None:
    main = "sequence:\n  - set: {number: 3}\n  - check: Even"
    tree, past = follow(main, Recalled(Outcome(True, ""), {}, has_begun=False))
    assert tree.finish() == "SUCCESS"
    assert past.told == [("visit", CHECK, True)]
    tree, past = follow(main)
    assert (tree.finish(), tree.reason) == ("FAILURE", "odd")
    assert past.told == [
        ("visit", CHECK, True),
        ("answered", CHECK, False, "odd", {}, {}, True),
    ]


def test_the_outputs_of_the_past_stand_on_the_keys_that_they_were_wired_to(follow: Any) -> None:
    main = 'sequence:\n  - run: Scan\n    out: {cloud: "{first}"}\n  - wait: 1 s'
    tree, _ = follow(main, Recalled(Outcome(True, ""), {"cloud": "an old cloud"}, has_begun=False))
    tree.tick()
    assert tree.runtime.store.get("first") == "an old cloud"


def test_a_leaf_that_had_not_begun_is_called_in_the_present(follow: Any) -> None:
    tree, past = follow(COUNT, Recalled(None, {}, has_begun=False))
    assert tree.finish() == "SUCCESS"
    assert [kind for kind, *_ in past.told] == ["visit", "visit", "called", "visit", "answered"]


def test_a_leaf_is_taken_up_once_and_called_in_the_next_round(follow: Any) -> None:
    main = "sequence:\n  - set: {least: 3}\n  - loop: {max: 2}\n    do: {run: Count}"
    tree, past = follow(main, Recalled(None, {}, has_begun=True))
    assert tree.finish() == "SUCCESS"
    told = [kind for kind, *_ in past.told if kind != "visit"]
    assert told == ["taken up", "answered", "called", "answered"]
