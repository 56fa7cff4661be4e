"""Reactive and persistent sequences: what they ask anew, and where they go on."""

from typing import Any

from tests.tree.composites.scripted_world import World, act, indented

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
