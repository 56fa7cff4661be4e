"""Sequences, fallbacks and parallels: what is ticked when, what is remembered,
what is cancelled.
"""

from typing import Any

import pytest

from executive.config import Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded


class ActSettings(Settings):
    id: str
    ticks: int = 1
    fails: bool = False


class World:
    """What the leaves of one test share: what they did, and what the condition says."""

    def __init__(self) -> None:
        self.log: list[str] = []
        self.is_safe = True

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
                world.log.append(f"{name} ends")
                if self.settings.fails:
                    return failed(f"{name} failed")
                return succeeded(reason=f"{name} done")

        class Safe(Condition):
            def check(self) -> Outcome[None]:
                return succeeded(reason="safe") if world.is_safe else failed("not safe")

        return {"Act": Act, "Safe": Safe}


def act(name: str, ticks: int = 1, fails: bool = False) -> str:
    return f"  - run: Act\n    with: {{id: {name}, ticks: {ticks}, fails: {str(fails).lower()}}}\n"


@pytest.fixture
def world() -> World:
    return World()


def test_a_sequence_goes_on_where_it_was_and_ends_with_the_first_failure(
    play: Any, world: World
) -> None:
    tree = play("sequence:\n" + act("a") + act("b", fails=True) + act("c"), leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("FAILURE", "b failed")
    assert world.log == ["a begins", "a ends", "b begins", "b ends"]


def test_a_sequence_that_was_cancelled_begins_anew(play: Any, world: World) -> None:
    tree = play("sequence:\n" + act("a", 0) + act("b", 2), leaves=world.leaves())
    tree.tick()
    tree.halt()
    assert tree.finish() == "SUCCESS"
    assert world.log == [
        "a begins",
        "a ends",
        "b begins",
        "b cancelled",
        "a begins",
        "a ends",
        "b begins",
        "b ends",
    ]


def test_a_fallback_tries_one_after_the_other_and_remembers_what_failed(
    play: Any, world: World
) -> None:
    tree = play(
        "fallback:\n" + act("a", fails=True) + act("b", 3) + act("c"), leaves=world.leaves()
    )
    assert (tree.finish(), tree.reason) == ("SUCCESS", "b done")
    assert world.log == ["a begins", "a ends", "b begins", "b ends"]


def test_a_fallback_without_success_fails_with_the_last_reason(play: Any, world: World) -> None:
    tree = play("fallback:\n" + act("a", fails=True) + act("b", fails=True), leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("FAILURE", "b failed")


def test_a_reactive_sequence_cancels_what_runs_when_an_earlier_condition_changes(
    play: Any, world: World
) -> None:
    tree = play("reactive_sequence:\n  - check: Safe\n" + act("a", 9), leaves=world.leaves())
    assert [tree.tick() for _ in range(2)] == ["RUNNING", "RUNNING"]
    world.is_safe = False
    assert (tree.tick(), tree.reason) == ("FAILURE", "not safe")
    assert world.log == ["a begins", "a cancelled"]
    assert ("main/1:Act", "halted") in tree.runtime.endings()


def test_a_reactive_fallback_cancels_what_runs_when_an_earlier_child_succeeds(
    play: Any, world: World
) -> None:
    world.is_safe = False
    tree = play("reactive_fallback:\n  - check: Safe\n" + act("a", 9), leaves=world.leaves())
    assert [tree.tick() for _ in range(2)] == ["RUNNING", "RUNNING"]
    world.is_safe = True
    assert (tree.tick(), tree.reason) == ("SUCCESS", "safe")
    assert world.log == ["a begins", "a cancelled"]


def test_an_earlier_child_of_a_reactive_fallback_takes_over_when_its_guard_opens(
    play: Any, world: World
) -> None:
    world.is_safe = False
    first = act("a", 2) + "    if: Safe\n"
    tree = play("reactive_fallback:\n" + first + act("b", 9), leaves=world.leaves())
    tree.tick(2)
    world.is_safe = True
    assert (tree.finish(), tree.reason) == ("SUCCESS", "a done")
    assert world.log == ["b begins", "a begins", "b cancelled", "a ends"]


def test_an_earlier_child_that_has_failed_in_time_does_not_disturb_the_one_it_called_for(
    play: Any, world: World
) -> None:
    children = act("a", 2, fails=True) + act("b", 4)
    tree = play("reactive_fallback:\n" + children, leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("SUCCESS", "b done")
    assert world.log == ["a begins", "a ends", "b begins", "b ends"]


def test_behind_a_guard_it_gets_another_chance_after_the_guard_was_closed(
    play: Any, world: World
) -> None:
    first = act("a", 1, fails=True) + "    if: Safe\n"
    tree = play("reactive_fallback:\n" + first + act("b", 9), leaves=world.leaves())
    tree.tick(4)
    assert world.log == ["a begins", "a ends", "b begins"]
    world.is_safe = False
    tree.tick()
    world.is_safe = True
    tree.tick()
    assert world.log == ["a begins", "a ends", "b begins", "a begins", "b cancelled"]


def test_a_condition_that_is_asked_at_every_tick_is_journalled_when_it_changes(
    play: Any, world: World
) -> None:
    tree = play("reactive_sequence:\n  - check: Safe\n" + act("a", 9), leaves=world.leaves())
    tree.tick(6)
    world.is_safe = False
    tree.tick()
    lines = [payload for kind, node, payload in tree.runtime.lines if node == "main/0:Safe"]
    assert lines == [
        {"status": "success", "reason": "safe"},
        {"status": "failure", "reason": "not safe"},
    ]


@pytest.mark.parametrize(
    ("succeed", "status", "ends"),
    [("all", "FAILURE", 3), ("one", "SUCCESS", 2), ("2", "SUCCESS", 5)],
)
def test_a_parallel_ends_when_its_count_is_reached_or_out_of_reach(
    play: Any, world: World, succeed: str, status: str, ends: int
) -> None:
    children = act("a", 1) + act("b", 2, fails=True) + act("c", 4)
    tree = play(f"parallel:\n{children}succeed: {succeed}", leaves=world.leaves())
    assert tree.finish() == status
    assert tree.ticks == ends


def test_a_parallel_does_not_tick_a_child_that_has_ended_and_cancels_those_that_have_not(
    play: Any, world: World
) -> None:
    tree = play(
        "parallel:\n" + act("a", 0) + act("b", 9) + act("c", 3, fails=True), leaves=world.leaves()
    )
    tree.finish()
    assert world.log.count("a begins") == 1
    assert world.log[-1] == "b cancelled"


def test_every_node_has_the_same_path_in_every_build_and_its_start_and_end_are_journalled(
    play: Any, world: World
) -> None:
    main = (
        "sequence:\n"
        + act("a")
        + "  - name: both\n    parallel:\n    "
        + act("b").replace("\n", "\n    ")
    )
    tree = play(main.rstrip(), leaves=world.leaves())
    tree.finish()
    paths = ["main", "main/0:Act", "main/1:both", "main/1:both/0:Act"]
    assert tree.runtime.told("node_started") == paths
    assert sorted(tree.runtime.told("node_ended")) == paths
    first = next(payload for kind, _, payload in tree.runtime.lines if kind == "node_ended")
    assert first == {"status": "success", "reason": "a done"}


def test_halting_in_the_middle_of_a_tick_leaves_nothing_under_way(play: Any, world: World) -> None:
    tree = play("sequence:\n" + act("a", 5), leaves=world.leaves())
    visits = tree.root.tick()
    next(visits)  # the leaf has been ticked, the sequence does not know yet that it runs
    tree.halt()
    assert world.log == ["a begins", "a cancelled"]
    assert all(node.status.name == "INVALID" for node in tree.root.iterate())
