"""Sequences and fallbacks: where they go on, what they remember, and what they cancel."""

from typing import Any

import pytest

from executive.tree.build import node_states
from tests.tree.composites.scripted_world import World, act


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


def statuses(tree: Any) -> dict[str, str]:
    return {row.path: row.status for row in node_states(tree.root)}


def test_a_fallback_shows_its_failed_alternatives_as_failed(play: Any, world: World) -> None:
    tree = play("fallback:\n" + act("a", fails=True) + act("b"), leaves=world.leaves())
    tree.finish()
    assert statuses(tree) == {"main": "SUCCESS", "main/0:Act": "FAILURE", "main/1:Act": "SUCCESS"}


def test_a_fallback_goes_on_after_a_sequence_that_was_left_out(play: Any, world: World) -> None:
    world.is_safe = False
    first = "  - sequence:\n    - run: Act\n      with: {id: a}\n      if: Safe\n"
    tree = play("fallback:\n" + first + act("b"), leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("SUCCESS", "b done")
    assert statuses(tree)["main/0:sequence"] == "SKIPPED"
    assert ("main/0:sequence", "skipped") in tree.runtime.endings()


@pytest.mark.parametrize(
    "kind",
    [
        "sequence",
        "fallback",
        "reactive_sequence",
        "reactive_fallback",
        "persistent_sequence",
        "parallel",
    ],
)
def test_a_composite_whose_children_were_all_left_out_is_left_out(
    play: Any, world: World, kind: str
) -> None:
    world.is_safe = False
    inner = f"  - {kind}:\n    - check: Safe\n      if: Safe\n    - check: Safe\n      if: Safe\n"
    tree = play("fallback:\n" + inner + act("b"), leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("SUCCESS", "b done")
    assert statuses(tree)[f"main/0:{kind}"] == "SKIPPED"
