"""Sequences, fallbacks and parallels: what is ticked when, what is remembered,
what is cancelled.
"""

from typing import Any

import pytest

from executive.config import Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.tree.build import node_states


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


def statuses(tree: Any) -> dict[str, str]:
    return {row.path: row.status for row in node_states(tree.root)}


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


def test_a_fallback_shows_its_failed_alternatives_as_failed(play: Any, world: World) -> None:
    tree = play("fallback:\n" + act("a", fails=True) + act("b"), leaves=world.leaves())
    tree.finish()
    assert statuses(tree) == {"main": "SUCCESS", "main/0:Act": "FAILURE", "main/1:Act": "SUCCESS"}


def indented(text: str) -> str:
    return "".join(f"  {line}\n" for line in text.splitlines())


def left_out(name: str) -> str:
    return act(name) + "    if: Safe\n"


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


ENSURE = """
  - fallback:
    - check: Safe
    - run: Act
      with: {id: ensure, ticks: 1}
"""


def test_a_postcondition_that_is_lost_is_restored_before_the_sequence_goes_on(
    play: Any, world: World
) -> None:
    world.is_safe = False
    tree = play("reactive_sequence:" + ENSURE + act("work", 3), leaves=world.leaves())
    tree.tick()
    world.is_safe = True
    tree.tick()
    world.is_safe = False
    tree.tick()
    world.is_safe = True
    assert (tree.finish(), tree.reason) == ("SUCCESS", "work done")
    assert world.log == [
        "ensure begins",
        "ensure ends",
        "work begins",
        "ensure begins",
        "work cancelled",
        "ensure ends",
        "work begins",
        "work ends",
    ]


def test_so_it_is_when_a_called_tree_restores_it(play: Any, world: World) -> None:
    world.is_safe = False
    called = "  ensure:" + ENSURE.replace("\n  - fallback:", "\n    fallback:", 1)
    tree = play(
        "reactive_sequence:\n  - call: ensure\n" + act("work", 3),
        leaves=world.leaves(),
        trees=called,
    )
    tree.tick(2)
    assert world.log == ["ensure begins", "ensure ends", "work begins"]
    tree.tick()
    assert world.log[3:] == ["ensure begins", "work cancelled"]


def test_an_action_before_the_last_child_is_begun_once_a_round(play: Any, world: World) -> None:
    tree = play("reactive_sequence:\n" + act("a", 1) + act("b", 3), leaves=world.leaves())
    assert tree.finish() == "SUCCESS"
    assert world.log == ["a begins", "a ends", "b begins", "b ends"]


def test_it_is_begun_again_after_a_child_before_it_has_run_again(play: Any, world: World) -> None:
    main = "reactive_sequence:" + ENSURE + act("a", 0) + act("b", 5)
    tree = play(main, leaves=world.leaves())
    tree.tick(2)
    world.is_safe = False
    tree.tick(3)
    assert world.log.count("a begins") == 2


def test_a_halted_reactive_sequence_cancels_the_earlier_child_that_runs(
    play: Any, world: World
) -> None:
    tree = play("reactive_sequence:\n" + act("a", 5) + act("b"), leaves=world.leaves())
    tree.tick(2)
    tree.halt()
    assert world.log == ["a begins", "a cancelled"]


def persistent(play: Any, world: World, **arguments: Any) -> Any:
    main = "retry: 2\ndo:\n  persistent_sequence:\n" + "".join(
        f"  {line}\n" for line in (act("a") + "  - check: Safe\n" + act("b")).splitlines()
    )
    return play(main, leaves=world.leaves(), **arguments)


def test_a_persistent_sequence_goes_on_at_the_child_that_failed(play: Any, world: World) -> None:
    world.is_safe = False
    tree = persistent(play, world)
    tree.tick(2)
    world.is_safe = True
    assert tree.finish() == "SUCCESS"
    assert world.log == ["a begins", "a ends", "b begins", "b ends"]


def test_it_fails_at_that_child_again_and_begins_anew_after_a_success(
    play: Any, world: World
) -> None:
    world.is_safe = False
    assert persistent(play, world).finish() == "FAILURE"
    assert world.log == ["a begins", "a ends"]
    world.is_safe = True
    world.log.clear()
    main = "loop: {max: 2}\ndo:\n  persistent_sequence:\n" + indented(act("a"))
    assert play(main, leaves=world.leaves()).finish() == "SUCCESS"
    assert world.log == ["a begins", "a ends"] * 2


def test_it_goes_on_at_the_child_that_was_halted(play: Any, world: World) -> None:
    tree = play("persistent_sequence:\n" + act("a") + act("b", 5), leaves=world.leaves())
    tree.tick(3)
    tree.halt()
    assert tree.finish() == "SUCCESS"
    assert world.log == ["a begins", "a ends", "b begins", "b cancelled", "b begins", "b ends"]


def test_in_a_tree_that_is_called_anew_it_begins_anew(play: Any, world: World) -> None:
    world.is_safe = False
    called = "  part:\n    persistent_sequence:\n" + indented(indented(act("a", 0)))
    called += "      - check: Safe\n"
    tree = play("call: part\nretry: 2", leaves=world.leaves(), trees=called)
    tree.finish()
    assert world.log == ["a begins", "a ends"] * 2  # the keys of the first call are gone
