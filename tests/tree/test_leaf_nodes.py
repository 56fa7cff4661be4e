"""Actions are driven as generators and cancelled cleanly; an exception ends the mission."""

import contextlib
import re
from dataclasses import make_dataclass
from typing import Any

import pytest

from executive.errors import RobotError
from executive.leaf.action import Action, Condition
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.runtime import MissionFaultError


def action(run: Any, **ports: Any) -> dict[str, type]:
    """Return a table with one action, `Act`, whose generator and ports are given."""
    return {"Act": _leaf("Act", Action, "run", run, ports)}


def condition(check: Any, **ports: Any) -> dict[str, type]:
    return {"Ask": _leaf("Ask", Condition, "check", check, ports)}


def _leaf(name: str, base: type, verb: str, does: Any, ports: dict[str, Any]) -> type:
    """Return a leaf whose ports are set after its class was made, not read from a signature."""
    leaf = type(name, (base,), {})
    setattr(leaf, verb, lambda self, **inputs: does(self, **inputs))
    leaf.__abstractmethods__ = frozenset()  # type: ignore[attr-defined]
    for side, known in ports.items():
        setattr(leaf, side, known)
    return leaf


def result(**values: Any) -> Any:
    """Return an instance of a result class with these fields."""
    return make_dataclass("Result", list(values))(**values)


def test_an_action_that_yields_nothing_ends_in_its_first_tick(play: Any) -> None:
    def run(self: Any) -> Any:
        yield from ()
        return succeeded(reason="done")

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
        return succeeded(reason=first + second)

    tree = play("run: Act", leaves=action(run))
    assert [tree.tick() for _ in range(3)] == ["RUNNING", "RUNNING", "SUCCESS"]
    assert tree.reason == "ab"


def test_what_a_job_raises_is_raised_where_the_action_waits(play: Any, job: Any) -> None:
    def run(self: Any) -> Any:
        try:
            yield job(1, ValueError("singular"))
        except ValueError as error:
            return succeeded(reason=f"cured: {error}")

    tree = play("run: Act", leaves=action(run))
    assert (tree.finish(), tree.reason) == ("SUCCESS", "cured: singular")


@pytest.mark.parametrize(
    "around",
    [
        "run: Act",
        "fallback: [{run: Act}, {wait: 1 s}]",
        "retry: 3\ndo: {run: Act}",
        "optional: true\ndo: {run: Act}",
    ],
)
@pytest.mark.parametrize("when", ["run", "job", "later"])
def test_an_exception_ends_the_mission_whatever_is_around_the_leaf(
    play: Any, job: Any, when: str, around: str
) -> None:
    def run(self: Any) -> Any:
        if when == "run":
            raise ZeroDivisionError("oops")
        yield job(0, ZeroDivisionError("oops")) if when == "job" else None
        raise ZeroDivisionError("oops")

    tree = play(around, leaves=action(run))
    with pytest.raises(MissionFaultError, match="Act failed: oops"):
        tree.finish()
    tree.halt()
    assert [type(error) for error in tree.runtime.errors] == [ZeroDivisionError]
    assert "wait" not in str(tree.runtime.endings())


def test_an_error_of_a_plugin_that_the_mission_can_do_without_is_a_failure(play: Any) -> None:
    def run(self: Any) -> Any:
        yield None
        raise ZeroDivisionError("oops")

    tree = play("run: Act", leaves=action(run))
    tree.runtime.can_do_without = True
    assert (tree.finish(), tree.reason) == ("FAILURE", "Act failed: oops")
    assert tree.runtime.endings() == [("main", "failure")]


def test_after_an_exception_a_halt_leaves_no_sibling_running(play: Any) -> None:
    def run(self: Any) -> Any:
        yield None
        raise RobotError("hydraulics")

    tree = play("parallel:\n  - wait: 9 s\n  - run: Act", leaves=action(run))
    with pytest.raises(MissionFaultError):
        tree.finish()
    tree.halt()
    assert [child.status.name for child in tree.root.children] == ["INVALID", "INVALID"]


def test_no_leaf_begins_after_an_error_in_a_clean_up(play: Any) -> None:
    begun: list[str] = []

    def run(self: Any, **inputs: Any) -> Any:
        try:
            yield None
            yield None
        finally:
            raise RobotError("valve stuck")

    def later(self: Any) -> Any:
        begun.append("later")
        yield None
        return succeeded()

    main = "fallback:\n  - run: Act\n    timeout: 0.1 s\n  - run: Later"
    leaves = {**action(run), "Later": action(later)["Act"]}
    tree = play(main, leaves=leaves)
    with pytest.raises(MissionFaultError):
        tree.finish()
    assert begun == []


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
        (succeeded(result(weight=3)), "declares no output 'weight'"),
        (succeeded(result(mass="heavy")), "output 'mass' of Act is float, got str"),
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
    with pytest.raises(MissionFaultError, match=re.escape(words)):
        tree.finish()


def test_an_action_without_a_yield_and_one_that_yields_something_strange_are_refused(
    play: Any,
) -> None:
    tree = play("run: Act", leaves=action(lambda self: succeeded()))
    with pytest.raises(MissionFaultError, match="is no generator: it needs a 'yield'"):
        tree.finish()

    def strange(self: Any) -> Any:
        yield 3

    tree = play("run: Act", leaves=action(strange))
    with pytest.raises(MissionFaultError, match="Act yielded int; an action yields a job or None"):
        tree.finish()


def test_a_failure_writes_its_outputs_so_that_a_recovery_can_read_them(play: Any) -> None:
    def run(self: Any) -> Any:
        yield None
        return failed("too heavy", result(mass=4.5))

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
        return succeeded(reason=str(given))

    tree = play(
        'sequence:\n  - set: {a: 1, two: 2}\n  - run: Act\n    in: {b: "{two}"}',
        leaves=action(run, inputs=inputs),
    )
    assert (tree.finish(), tree.reason) == ("SUCCESS", "{'a': 1, 'b': 2, 'c': None}")


def test_a_condition_answers_in_one_tick_and_its_exception_ends_the_mission(play: Any) -> None:
    tree = play("check: Ask", leaves=condition(lambda self: succeeded(reason="yes")))
    assert (tree.tick(), tree.reason) == ("SUCCESS", "yes")
    tree = play("check: Ask", leaves=condition(lambda self: 1 / 0))
    with pytest.raises(MissionFaultError, match="division by zero"):
        tree.tick()
    assert len(tree.runtime.errors) == 1
