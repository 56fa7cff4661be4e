"""if/then/else, while/do/else, switch, not, force_failure, once, on_halt: each to success, to
failure, and halted.
"""

from typing import Any

import pytest

from executive.config import Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded


class ActSettings(Settings):
    id: str = "a"
    ticks: int = 0
    fails: bool = False


class World:
    def __init__(self) -> None:
        self.log: list[str] = []
        self.is_open = True
        self.asked = 0

    def leaves(self) -> dict[str, type]:
        world = self

        class Act(Action[ActSettings]):
            def run(self) -> Steps[None]:
                name = self.settings.id
                world.log.append(f"{name} begins")
                try:
                    for _ in range(self.settings.ticks):
                        yield None
                except GeneratorExit:
                    world.log.append(f"{name} cancelled")
                    raise
                return failed(f"{name} failed") if self.settings.fails else succeeded()

        class Open(Condition):
            def check(self) -> Outcome[None]:
                world.asked += 1
                return succeeded(reason="open") if world.is_open else failed("closed")

        class Tidy(Condition):
            def check(self) -> Outcome[None]:
                world.log.append("tidied")
                return succeeded()

        return {"Act": Act, "Open": Open, "Tidy": Tidy}


@pytest.fixture
def world() -> World:
    return World()


def act(name: str, ticks: int = 0, fails: bool = False) -> str:
    return f"{{run: Act, with: {{id: '{name}', ticks: {ticks}, fails: {str(fails).lower()}}}}}"


CHOICE = f"if: Open\nthen: {act('yes', 3)}\nelse: {act('no', 3)}"


@pytest.mark.parametrize(("is_open", "branch"), [(True, "yes"), (False, "no")])
def test_if_asks_once_and_takes_one_branch_to_its_end(
    play: Any, world: World, is_open: bool, branch: str
) -> None:
    world.is_open = is_open
    tree = play(CHOICE, leaves=world.leaves())
    tree.tick()
    world.is_open = not is_open
    assert tree.finish() == "SUCCESS"
    assert (world.log, world.asked) == ([f"{branch} begins"], 1)


def test_if_fails_with_its_branch_and_is_halted_with_it(play: Any, world: World) -> None:
    tree = play(f"if: Open\nthen: {act('yes', 0, True)}\nelse: {act('no')}", leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("FAILURE", "yes failed")
    tree = play(CHOICE, leaves=world.leaves())
    tree.tick()
    tree.halt()
    assert world.log[-1] == "yes cancelled"


def test_without_else_it_is_left_out(play: Any, world: World) -> None:
    world.is_open = False
    tree = play(
        f"fallback:\n  - if: Open\n    then: {act('yes')}\n  - {act('next')}",
        leaves=world.leaves(),
    )
    assert tree.finish() == "SUCCESS"
    assert world.log == ["next begins"]


def test_while_asks_at_each_tick_and_changes_the_branch(play: Any, world: World) -> None:
    tree = play(f"while: Open\ndo: {act('yes', 3)}\nelse: {act('no', 3)}", leaves=world.leaves())
    tree.tick(2)
    world.is_open = False
    tree.tick()
    assert world.log == ["yes begins", "yes cancelled", "no begins"]
    assert world.asked == 3
    world.is_open = True
    assert tree.finish() == "SUCCESS"
    assert world.log[3:] == ["no cancelled", "yes begins"]


def test_while_else_fails_with_its_branch_and_is_halted_with_it(play: Any, world: World) -> None:
    main = f"while: Open\ndo: {act('yes', 3)}\nelse: {act('no', 0, True)}"
    tree = play(main, leaves=world.leaves())
    tree.tick()
    tree.halt()
    assert world.log == ["yes begins", "yes cancelled"]
    world.is_open = False
    assert (tree.finish(), tree.reason) == ("FAILURE", "no failed")


def switched(value: str, otherwise: str = "") -> str:
    return (
        f'sequence:\n  - set: {{size: {value}}}\n  - switch: "{{size}}"\n    cases:\n'
        f"      large: {act('large', 2)}\n      '2': {act('two', 2)}\n"
        f"      'true': {act('true', 0, True)}\n{otherwise}"
    )


@pytest.mark.parametrize(
    ("value", "log", "status"),
    [
        ("large", ["large begins"], "SUCCESS"),
        ("2", ["two begins"], "SUCCESS"),
        ("true", ["true begins"], "FAILURE"),
        ("small", [], "FAILURE"),
    ],
)
def test_switch_ticks_the_case_that_the_value_names(
    play: Any, world: World, value: str, log: list[str], status: str
) -> None:
    tree = play(switched(value), leaves=world.leaves())
    assert tree.finish() == status
    assert world.log == log


def test_switch_without_a_case_takes_else_or_says_which_cases_there_are(
    play: Any, world: World
) -> None:
    tree = play(switched("small"), leaves=world.leaves())
    tree.finish()
    assert tree.reason == "no case for 'small' (cases: large, 2, true)"
    tree = play(switched("small", f"    else: {act('other')}"), leaves=world.leaves())
    assert tree.finish() == "SUCCESS"
    assert world.log == ["other begins"]


def test_switch_changes_its_case_with_the_value_and_is_halted_with_it(
    play: Any, world: World
) -> None:
    tree = play(switched("large"), leaves=world.leaves())
    tree.tick()
    tree.runtime.store.set("size", 2)
    tree.tick()
    tree.halt()
    assert world.log == ["large begins", "large cancelled", "two begins", "two cancelled"]


@pytest.mark.parametrize(("fails", "status"), [(False, "FAILURE"), (True, "SUCCESS")])
def test_not_turns_the_end_around(play: Any, world: World, fails: bool, status: str) -> None:
    assert play(f"not: {act('a', 1, fails)}", leaves=world.leaves()).finish() == status


@pytest.mark.parametrize("fails", [False, True])
def test_force_failure_fails_in_any_case(play: Any, world: World, fails: bool) -> None:
    tree = play(f"force_failure: {act('a', 1, fails)}", leaves=world.leaves())
    assert (tree.finish(), tree.ticks) == ("FAILURE", 2)


@pytest.mark.parametrize("kind", ["not", "force_failure"])
def test_both_pass_on_a_halt_and_what_is_left_out(play: Any, world: World, kind: str) -> None:
    tree = play(f"{kind}: {act('a', 5)}", leaves=world.leaves())
    tree.tick()
    tree.halt()
    assert world.log == ["a begins", "a cancelled"]
    world.is_open = False
    main = f"fallback:\n  - {kind}: {{run: Act, if: Open}}\n  - {act('b')}"
    assert play(main, leaves=world.leaves()).finish() == "SUCCESS"
    assert world.log[-1] == "b begins"


@pytest.mark.parametrize("fails", [False, True])
def test_once_runs_to_its_end_once_and_is_left_out_afterwards(
    play: Any, world: World, fails: bool
) -> None:
    first = act("a", 1, fails).replace("run:", "once: true, run:")
    main = f"loop: {{max: 3}}\ndo:\n  fallback:\n    - {first}\n    - {act('b')}"
    assert play(main, leaves=world.leaves()).finish() == "SUCCESS"
    assert world.log.count("a begins") == 1
    assert world.log.count("b begins") == (3 if fails else 2)


def test_once_begins_again_what_was_halted(play: Any, world: World) -> None:
    tree = play("run: Act\nwith: {ticks: 3}\nonce: true", leaves=world.leaves())
    tree.tick()
    tree.halt()
    tree.finish()
    tree.finish()
    assert world.log == ["a begins", "a cancelled", "a begins"]


HALTED = "run: Act\nwith: {ticks: 9}\non_halt: {check: Tidy}"


def test_on_halt_is_ticked_when_the_node_is_cancelled_and_not_otherwise(
    play: Any, world: World
) -> None:
    tree = play(HALTED, leaves=world.leaves())
    assert tree.finish() == "SUCCESS"
    assert world.log == ["a begins"]
    tree.tick()
    tree.halt()
    tree.halt()
    assert world.log[1:] == ["a begins", "a cancelled", "tidied"]
    assert ("main@on_halt/0:Tidy", "success") in tree.runtime.endings()


def test_on_halt_follows_a_timeout_too(play: Any, world: World) -> None:
    assert play(HALTED + "\ntimeout: 0.3 s", leaves=world.leaves()).finish() == "FAILURE"
    assert world.log == ["a begins", "a cancelled", "tidied"]


def test_on_halt_begins_nothing_after_a_fault(play: Any, world: World) -> None:
    tree = play(HALTED, leaves=world.leaves())
    tree.tick()
    tree.runtime.is_faulted = True
    tree.halt()
    assert world.log == ["a begins", "a cancelled"]
