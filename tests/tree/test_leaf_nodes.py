"""Actions are driven as generators, cancelled cleanly, and never let an exception out."""

import contextlib
from typing import Any

import pytest

from executive.errors import RobotError
from executive.leaf.action import Action, Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.port import Port


def action(run: Any, **attributes: Any) -> dict[str, type]:
    """Return a table with one action, `Act`, whose generator is given."""
    return {
        "Act": type(
            "Act", (Action,), {"run": lambda self, **inputs: run(self, **inputs), **attributes}
        )
    }


def condition(check: Any, **attributes: Any) -> dict[str, type]:
    return {
        "Ask": type(
            "Ask",
            (Condition,),
            {"check": lambda self, **inputs: check(self, **inputs), **attributes},
        )
    }


def test_an_action_that_yields_nothing_ends_in_its_first_tick(play: Any) -> None:
    def run(self: Any) -> Any:
        yield from ()
        return succeeded("done")

    tree = play("run: Act", leaves=action(run))
    assert (tree.tick(), tree.reason) == ("SUCCESS", "done")


def test_an_action_that_yields_none_is_resumed_at_the_next_tick(play: Any) -> None:
    def run(self: Any) -> Any:
        yield None
        yield None
        return failed("no luck")

    tree = play("run: Act", leaves=action(run))
    assert [tree.tick() for _ in range(3)] == ["RUNNING", "RUNNING", "FAILURE"]
    assert tree.reason == "no luck"


def test_a_job_resumes_the_action_with_its_result_in_the_tick_in_which_it_is_ready(
    play: Any, job: Any
) -> None:
    def run(self: Any) -> Any:
        first = yield job(0, "a")
        second = yield job(2, "b")
        return succeeded(first + second)

    tree = play("run: Act", leaves=action(run))
    assert [tree.tick() for _ in range(3)] == ["RUNNING", "RUNNING", "SUCCESS"]
    assert tree.reason == "ab"


def test_what_a_job_raises_is_raised_where_the_action_waits(play: Any, job: Any) -> None:
    def run(self: Any) -> Any:
        try:
            yield job(1, ValueError("singular"))
        except ValueError as error:
            return succeeded(f"cured: {error}")

    tree = play("run: Act", leaves=action(run))
    assert (tree.finish(), tree.reason) == ("SUCCESS", "cured: singular")


@pytest.mark.parametrize("when", ["run", "job", "later"])
def test_an_exception_is_a_failure_with_a_reason_and_the_runtime_hears_of_it(
    play: Any, job: Any, when: str
) -> None:
    def run(self: Any) -> Any:
        if when == "run":
            raise ZeroDivisionError("oops")
        yield job(0, ZeroDivisionError("oops")) if when == "job" else None
        raise ZeroDivisionError("oops")

    tree = play("run: Act", leaves=action(run))
    assert (tree.finish(), tree.reason) == ("FAILURE", "ZeroDivisionError: oops")
    assert [type(error) for error in tree.runtime.errors] == [ZeroDivisionError]
    assert tree.runtime.lines[-1] == (
        "node_ended",
        "main",
        {"status": "failure", "reason": "ZeroDivisionError: oops"},
    )


def test_an_exception_leaves_no_sibling_running(play: Any) -> None:
    def run(self: Any) -> Any:
        yield None
        raise RobotError("hydraulics")

    tree = play("parallel:\n  - wait: 9 s\n  - run: Act", leaves=action(run))
    assert tree.finish() == "FAILURE"
    assert [child.status.name for child in tree.root.children] == ["INVALID", "FAILURE"]


def test_cancelling_gives_up_the_job_and_runs_the_finally_block(play: Any, job: Any) -> None:
    told: list[str] = []
    under_way = job(99)

    def run(self: Any) -> Any:
        try:
            yield under_way
        finally:
            told.append(f"cleaned, job cancelled: {under_way.is_cancelled}")

    tree = play("run: Act", leaves=action(run))
    tree.tick()
    tree.halt()
    assert told == ["cleaned, job cancelled: True"]
    assert tree.runtime.endings() == [("main", "halted")]
    tree.halt()
    assert len(told) == 1


def test_an_error_while_cancelling_does_not_keep_others_from_being_cancelled(
    play: Any, job: Any
) -> None:
    def run(self: Any) -> Any:
        try:
            yield None
        finally:
            raise RobotError("valve stuck")

    tree = play("parallel:\n  - run: Act\n  - wait: 9 s", leaves=action(run))
    tree.tick()
    tree.halt()
    assert [str(error) for error in tree.runtime.errors] == ["valve stuck"]
    assert dict(tree.runtime.endings()) == {
        "main/0:Act": "halted",
        "main/1:wait": "halted",
        "main": "halted",
    }


def test_a_cancelled_action_begins_anew(play: Any) -> None:
    begun: list[int] = []

    def run(self: Any) -> Any:
        begun.append(1)
        yield None
        return succeeded()

    tree = play("run: Act", leaves=action(run))
    tree.tick()
    tree.halt()
    assert tree.finish() == "SUCCESS"
    assert len(begun) == 2


def test_a_generator_that_refuses_to_end_is_reported(play: Any) -> None:
    def run(self: Any) -> Any:
        with contextlib.suppress(GeneratorExit):
            yield None
        yield None

    tree = play("run: Act", leaves=action(run))
    tree.tick()
    tree.halt()
    assert "ignored GeneratorExit" in str(tree.runtime.errors[0])


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, "ended with NoneType, not with succeeded(…) or failed(…)"),
        (succeeded(weight=3), "declares no output 'weight'"),
        (succeeded(mass="heavy"), "output 'mass' of Act is float, got str"),
        (succeeded(), "succeeded without its output 'mass'"),
    ],
)
def test_an_action_that_breaks_its_contract_fails_with_the_reason(
    play: Any, answer: Any, words: str
) -> None:
    def run(self: Any) -> Any:
        yield None
        return answer

    tree = play("run: Act", leaves=action(run, outputs={"mass": Port(float, "mass [kg]")}))
    assert tree.finish() == "FAILURE"
    assert words in tree.reason


def test_an_action_without_a_yield_and_one_that_yields_something_strange_are_refused(
    play: Any,
) -> None:
    tree = play("run: Act", leaves=action(lambda self: succeeded()))
    assert (tree.finish(), tree.reason) == (
        "FAILURE",
        "run() of Act is no generator: it needs a 'yield'",
    )

    def strange(self: Any) -> Any:
        yield 3

    tree = play("run: Act", leaves=action(strange))
    assert (tree.finish(), tree.reason) == (
        "FAILURE",
        "Act yielded int; an action yields a job or None",
    )


def test_a_failure_writes_its_outputs_so_that_a_recovery_can_read_them(play: Any) -> None:
    def run(self: Any) -> Any:
        yield None
        return Outcome(False, "too heavy", {"mass": 4.5})

    main = 'sequence:\n  - run: Act\n    out: {mass: "{weight}"}'
    tree = play(main, leaves=action(run, outputs={"mass": Port(float, "mass [kg]")}))
    assert tree.finish() == "FAILURE"
    assert tree.runtime.store.get("weight") == 4.5


def test_inputs_come_from_the_keys_that_they_are_wired_to_and_optional_ones_may_be_missing(
    play: Any,
) -> None:
    inputs = {"a": Port(int, ""), "b": Port(int, ""), "c": Port(int, "", optional=True)}

    def run(self: Any, **given: Any) -> Any:
        yield None
        return succeeded(str(given))

    tree = play(
        'sequence:\n  - set: {a: 1, two: 2}\n  - run: Act\n    in: {b: "{two}"}',
        leaves=action(run, inputs=inputs),
    )
    assert (tree.finish(), tree.reason) == ("SUCCESS", "{'a': 1, 'b': 2, 'c': None}")


def test_a_condition_answers_in_one_tick_and_its_exception_is_a_no(play: Any) -> None:
    tree = play("check: Ask", leaves=condition(lambda self: succeeded("yes")))
    assert (tree.tick(), tree.reason) == ("SUCCESS", "yes")
    tree = play("check: Ask", leaves=condition(lambda self: 1 / 0))
    assert (tree.tick(), tree.reason) == ("FAILURE", "ZeroDivisionError: division by zero")
    assert len(tree.runtime.errors) == 1
