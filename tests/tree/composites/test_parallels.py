"""Parallels: when they end, and what they cancel."""

from typing import Any

import pytest

from tests.tree.composites.scripted_world import World, act, indented


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


def test_a_branch_whose_condition_was_false_for_one_tick_takes_over_again(
    play: Any, world: World
) -> None:
    first = "  - reactive_sequence:\n    - check: Safe\n" + indented(act("a", 3))
    tree = play("reactive_fallback:\n" + first + act("b", 9), leaves=world.leaves())
    tree.tick(2)
    world.is_safe = False
    tree.tick()
    world.is_safe = True
    assert (tree.finish(), tree.reason) == ("SUCCESS", "a done")
    assert world.log == [
        "a begins",
        "a cancelled",
        "b begins",
        "a begins",
        "b cancelled",
        "a ends",
    ]


def test_so_does_a_branch_under_while(play: Any, world: World) -> None:
    first = act("a", 3) + "    while: Safe\n"
    tree = play("reactive_fallback:\n" + first + act("b", 9), leaves=world.leaves())
    tree.tick()
    world.is_safe = False
    tree.tick()
    world.is_safe = True
    assert (tree.finish(), tree.reason) == ("SUCCESS", "a done")


def test_a_parallel_that_is_lost_begins_nothing_more(play: Any, world: World) -> None:
    world.is_safe = False
    tree = play("parallel:\n  - check: Safe\n" + act("a"), leaves=world.leaves())
    assert (tree.tick(), tree.reason) == ("FAILURE", "not safe")
    assert world.log == []


def left_out(name: str) -> str:
    return act(name) + "    if: Safe\n"


def test_a_parallel_counts_a_child_that_was_left_out_neither_way(play: Any, world: World) -> None:
    world.is_safe = False
    tree = play("parallel:\n" + left_out("a") + act("b"), leaves=world.leaves())
    assert tree.finish() == "SUCCESS"
    tree = play("parallel:\n" + left_out("a") + act("b") + "succeed: 2", leaves=world.leaves())
    assert tree.finish() == "SUCCESS"  # two of two are all
    main = "parallel:\n" + left_out("a") + left_out("b") + act("c") + "succeed: 2"
    tree = play(main, leaves=world.leaves())
    assert (tree.finish(), tree.reason) == (
        "FAILURE",
        "2 children were left out, and 2 are to succeed",
    )


@pytest.mark.parametrize(
    ("keys", "status", "ticks"),
    [
        ("fail: one", "FAILURE", 2),
        ("fail: 2", "SUCCESS", 5),
        ("fail: 3", "SUCCESS", 4),
        ("succeed: one\nfail: one", "FAILURE", 2),
        ("wait_for_all: true", "FAILURE", 5),
        ("wait_for_all: true\nfail: 2", "SUCCESS", 5),
    ],
)
def test_a_parallel_ends_by_its_thresholds(
    play: Any, world: World, keys: str, status: str, ticks: int
) -> None:
    children = act("a", 1, fails=True) + act("b", 3) + act("c", 4)
    tree = play(f"parallel:\n{children}{keys}", leaves=world.leaves())
    assert (tree.finish(), tree.ticks) == (status, ticks)


def test_a_halted_parallel_cancels_what_runs(play: Any, world: World) -> None:
    tree = play("parallel:\n" + act("a", 0) + act("b", 9), leaves=world.leaves())
    tree.tick()
    tree.halt()
    assert world.log == ["a begins", "a ends", "b begins", "b cancelled"]
