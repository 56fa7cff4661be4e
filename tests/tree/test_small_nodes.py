"""wait, set, ask, call: nodes that call no plugin."""

import textwrap
from dataclasses import dataclass
from typing import Any

import pytest

from executive.errors import ConfigError
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.runtime import Question
from executive.tree.problem import MissionFileError


class Later(Question):
    """Answers after a number of polls."""

    def __init__(self, answer: bool | str, polls: int = 0) -> None:
        self._answer = answer
        self._polls = polls

    def answer(self) -> bool | str | None:
        self._polls -= 1
        return self._answer if self._polls < 0 else None

    def source(self) -> str:
        return "operator"


@dataclass(frozen=True)
class Number:
    """A number.

    Attributes:
        result: A number.
    """

    result: int


class Double(Action):
    def run(self, number: int) -> Steps[Number]:
        yield None
        return succeeded(Number(2 * number))


class Break(Action):
    def run(self) -> Steps[Number]:
        yield None
        return failed("broken", Number(-1))


LEAVES = {"Double": Double, "Break": Break}


def test_wait_takes_the_missions_time(play: Any) -> None:
    tree = play("wait: 1 s")
    assert tree.finish() == "SUCCESS"
    assert tree.ticks == 11  # at 0.0, 0.1 … 1.0 s


def test_set_writes_literals_and_copies_of_keys(play: Any) -> None:
    tree = play('sequence:\n  - set: {a: 1, b: [x, y]}\n  - set: {c: "{b}", d: "text"}')
    assert tree.finish() == "SUCCESS"
    assert {key: tree.runtime.store.get(key) for key in "abcd"} == {
        "a": 1,
        "b": ["x", "y"],
        "c": ["x", "y"],
        "d": "text",
    }


@pytest.mark.parametrize(("answer", "status"), [(True, "SUCCESS"), (False, "FAILURE")])
def test_ask_waits_for_the_operator_and_the_journal_says_who_answered(
    play: Any, answer: bool, status: str
) -> None:
    tree = play("ask: Is the area clear?")
    tree.runtime.answer = Later(answer, polls=2)
    assert tree.finish() == status
    assert tree.ticks == 3
    told = {"question": "Is the area clear?", "answer": answer, "source": "operator"}
    assert ("question_answered", "main", told) in tree.runtime.lines


def test_a_question_that_nobody_can_answer_is_a_failure_with_a_reason(play: Any) -> None:
    tree = play("ask: Is the area clear?")
    tree.runtime.answer = ConfigError("no one can answer")
    assert (tree.finish(), tree.reason) == ("FAILURE", "no one can answer")


def test_a_call_carries_values_in_and_out_and_keeps_the_rest_to_itself(play: Any) -> None:
    main = (
        'sequence:\n  - set: {mine: 4}\n  - call: twice\n    in: {number: "{mine}"}\n    '
        'out: {result: "{eight}"}'
    )
    trees = "  twice:\n    in: {number: int}\n    out: {result: int}\n    run: Double\n"
    tree = play(main, trees=trees, leaves=LEAVES)
    assert tree.finish() == "SUCCESS"
    assert tree.runtime.store.get("eight") == 8
    assert set(tree.runtime.store.keys()) == {"mine", "eight"}


def test_a_call_takes_literals_and_unlisted_ports_take_the_key_of_their_name(play: Any) -> None:
    trees = "  twice:\n    in: {number: int}\n    out: {result: int}\n    run: Double\n"
    tree = play("sequence:\n  - call: twice\n    in: {number: 5}\n", trees=trees, leaves=LEAVES)
    assert tree.finish() == "SUCCESS"
    assert tree.runtime.store.get("result") == 10
    tree = play("sequence:\n  - set: {number: 6}\n  - call: twice", trees=trees, leaves=LEAVES)
    assert tree.finish() == "SUCCESS"
    assert tree.runtime.store.get("result") == 12


def test_each_call_begins_with_an_empty_store(play: Any) -> None:
    body = (
        "  once:\n    fallback:\n      - sequence:\n          - check: HasKey\n      - "
        "set: {key: 1}\n"
    )
    seen: list[bool] = []

    class HasKey(Condition):
        def check(self, key: int | None = None) -> Outcome[None]:
            seen.append(key is not None)
            return failed("always")

    tree = play("sequence:\n  - call: once\n  - call: once", trees=body, leaves={"HasKey": HasKey})
    assert tree.finish() == "SUCCESS"
    assert seen == [False, False]


def test_a_call_that_fails_carries_out_what_was_written(play: Any) -> None:
    trees = "  broken:\n    out: {result: int}\n    run: Break\n"
    tree = play("call: broken", trees=trees, leaves=LEAVES)
    assert (tree.finish(), tree.reason) == ("FAILURE", "broken")
    assert tree.runtime.store.get("result") == -1


def test_an_optional_input_of_a_tree_may_be_missing(play: Any) -> None:
    trees = "  quiet:\n    in: {number: int?}\n    wait: 0.1 s\n"
    assert play("call: quiet", trees=trees).finish() == "SUCCESS"


def test_the_nodes_of_a_subtree_have_the_path_of_the_call(play: Any) -> None:
    trees = "  twice:\n    in: {number: int}\n    sequence:\n      - run: Double\n"
    tree = play(
        "sequence:\n  - call: twice\n    in: {number: 1}\n    name: first\n",
        trees=trees,
        leaves=LEAVES,
    )
    tree.finish()
    assert tree.runtime.told("node_started") == [
        "main",
        "main/0:first",
        "main/0:first/0:sequence",
        "main/0:first/0:sequence/0:Double",
    ]


def test_two_missions_in_one_process_do_not_see_each_other(play: Any) -> None:
    first, second = play("set: {a: 1}"), play("set: {a: 2}")
    first.finish()
    second.finish()
    assert (first.runtime.store.get("a"), second.runtime.store.get("a")) == (1, 2)


def test_a_key_that_was_never_written_at_run_time_is_a_failure_with_a_reason(play: Any) -> None:
    late = (
        "  - optional: true\n    do:\n      sequence:\n        - run: Stop\n        - set: "
        "{late: 1}\n"
    )
    main = f'sequence:\n{late}  - set: {{copy: "{{late}}"}}'

    class Stop(Action):
        def run(self) -> Steps[None]:
            yield None
            return failed("stop")

    tree = play(main, leaves={"Stop": Stop})
    assert (tree.finish(), tree.reason) == (
        "FAILURE",
        "key 'late' is read before it is written; there is none",
    )


def test_a_call_that_is_cancelled_carries_out_what_was_written(play: Any) -> None:
    trees = "  slow:\n    out: {result: int}\n    sequence: [{set: {result: 5}}, {wait: 9 s}]\n"
    tree = play("call: slow\ntimeout: 0.2 s", trees=trees)
    assert tree.finish() == "FAILURE"
    assert tree.runtime.store.get("result") == 5


def test_a_question_is_filled_in_and_a_choice_goes_into_a_key(play: Any) -> None:
    tree = play(
        "sequence:\n  - set: {id: 3, mass: 0.8 t}\n"
        "  - ask: Where to with stone {id} of {mass} kg?\n"
        '    choices: [left, right]\n    out: {answer: "{side}"}\n'
        "  - {wait: 0.1 s, if: \"{side} == 'right'\"}"
    )
    tree.runtime.answer = Later("right", polls=2)
    assert tree.finish() == "SUCCESS"
    assert tree.runtime.store.get("side") == "right"
    told = {"question": "Where to with stone 3 of 800 kg?", "answer": "right", "source": "operator"}
    assert ("question_answered", "main/1:ask", told) in tree.runtime.lines


def test_a_choice_that_nobody_makes_is_a_failure(play: Any) -> None:
    tree = play("ask: Where to?\nchoices: [left, right]")
    tree.runtime.answer = Later("", polls=0)
    assert tree.finish() == "FAILURE"
    assert "nobody chose" in tree.reason


def test_the_time_of_observing_anew_counts_against_no_timeout(play: Any) -> None:
    tree = play("timeout: 1 s\nsequence:\n  - wait: 0.5 s\n  - wait: 0.8 s")
    tree.tick(8)
    tree.runtime.uncounted_s = 0.5
    assert tree.finish() == "SUCCESS"
    late = play("timeout: 1 s\nsequence:\n  - wait: 0.5 s\n  - wait: 0.8 s")
    assert late.finish() == "FAILURE"


@pytest.mark.parametrize(
    ("ask", "mistake"),
    [
        ("choices: [a]", "'choices' needs at least two texts"),
        ("choices: []", "'choices' takes a list of at least one item"),
        ("choices: [a, A]", "two of the 'choices' are the same"),
        ("choices: [a, b]\ndefault: c", "'default' is one of a, b, not 'c'"),
        (
            "choices: [a, b]\nout: {anser: '{x}'}",
            "ask has no output 'anser'. Did you mean 'answer'?",
        ),
        (
            "out: {answer: '{x}'}",
            "'out' of ask takes the choice, and there are no 'choices'; yes is success and no is "
            "failure",
        ),
        ("default: maybe", "'default' is true or false, not 'maybe'"),
    ],
)
def test_mistakes_of_a_question_are_told(play: Any, ask: str, mistake: str) -> None:
    with pytest.raises(MissionFileError) as caught:
        play(f"sequence:\n  - ask: Where to?\n{textwrap.indent(ask, '    ')}")
    assert [problem.message for problem in caught.value.problems] == [mistake]


def test_a_question_reads_only_keys_that_are_written(play: Any) -> None:
    with pytest.raises(MissionFileError, match=r"'ask' reads key 'stone' before it is written"):
        play("ask: Lift stone {stone.id}?")


def test_a_call_that_is_repeated_begins_anew_each_time_with_the_inputs_of_then(play: Any) -> None:
    trees = "  twice:\n    in: {number: int}\n    out: {result: int}\n    run: Double\n"
    main = (
        "sequence:\n  - set: {mine: 1}\n  - loop: {max: 4}\n    do:\n      call: twice\n"
        '      in: {number: "{mine}"}\n      out: {result: "{mine}"}'
    )
    tree = play(main, trees=trees, leaves=LEAVES)
    assert tree.finish() == "SUCCESS"
    assert tree.runtime.store.get("mine") == 2**4
