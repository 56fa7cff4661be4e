"""Loops and for_each."""

from dataclasses import dataclass
from typing import Any

import pytest

from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded


class World:
    def __init__(self, left: int = 3) -> None:
        self.left = left
        self.seen: list[Any] = []

    def leaves(self) -> dict[str, type]:
        world = self

        class Work(Action):
            def run(self, item: object | None = None) -> Steps[None]:
                world.seen.append(item)
                yield None
                world.left -= 1
                return succeeded() if item != "bad" else failed("bad item")

        class Done(Condition):
            def check(self) -> Outcome[None]:
                return (
                    succeeded(reason="all done")
                    if world.left <= 0
                    else failed(f"{world.left} left")
                )

        return {"Work": Work, "Done": Done}


def test_a_loop_ends_when_its_condition_holds(play: Any) -> None:
    world = World(left=3)
    tree = play("loop: {until: Done, max: 9}\ndo: {run: Work}", leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("SUCCESS", "all done")
    assert len(world.seen) == 3


def test_a_loop_whose_condition_holds_from_the_start_does_nothing(play: Any) -> None:
    world = World(left=0)
    tree = play("loop: {until: Done}\ndo: {run: Work}", leaves=world.leaves())
    assert tree.tick() == "SUCCESS"
    assert world.seen == []


def test_a_loop_that_does_not_get_there_fails(play: Any) -> None:
    world = World(left=9)
    tree = play("loop: {until: Done, max: 2}\ndo: {run: Work}", leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("FAILURE", "not there after 2 rounds: 7 left")


def test_a_condition_that_holds_after_the_last_round_is_a_success(play: Any) -> None:
    world = World(left=2)
    tree = play("loop: {until: Done, max: 2}\ndo: {run: Work}", leaves=world.leaves())
    assert tree.finish() == "SUCCESS"


def test_a_loop_without_a_condition_ends_after_its_rounds(play: Any) -> None:
    world = World()
    tree = play("loop: {max: 4}\ndo: {run: Work}", leaves=world.leaves())
    assert (tree.finish(), tree.reason, len(world.seen)) == ("SUCCESS", "4 rounds", 4)


def test_for_each_gives_each_item_in_order_and_says_how_far_it_is(play: Any) -> None:
    world = World()
    tree = play("for_each: {item: item, in: [a, b, c]}\ndo: {run: Work}", leaves=world.leaves())
    tree.tick(3)
    assert tree.reason == "2 of 3"
    assert tree.finish() == "SUCCESS"
    assert world.seen == ["a", "b", "c"]


def test_for_each_of_an_empty_list_succeeds_and_never_ticks_its_body(play: Any) -> None:
    world = World()
    tree = play('sequence:\n  - set: {none: []}\n  - for_each: {item: item, in: "{none}"}\n    do: '
'{run: Work}',
                leaves=world.leaves())  # fmt: skip
    assert tree.finish() == "SUCCESS"
    assert world.seen == []


def test_for_each_fails_with_its_body(play: Any) -> None:
    world = World()
    tree = play("for_each: {item: item, in: [a, bad, c]}\ndo: {run: Work}", leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("FAILURE", "bad item")
    assert world.seen == ["a", "bad"]


def test_a_cancelled_loop_and_for_each_begin_anew(play: Any) -> None:
    world = World()
    tree = play("for_each: {item: item, in: [a, b]}\ndo: {run: Work}", leaves=world.leaves())
    tree.tick(3)
    tree.halt()
    assert tree.finish() == "SUCCESS"
    assert world.seen == ["a", "b", "a", "b"]


def test_a_value_that_is_no_list_is_a_failure_with_a_reason(play: Any) -> None:
    world = World()
    main = 'sequence:\n  - run: Odd\n  - for_each: {item: item, in: "{items}"}\n    do: {run: Work}'

    @dataclass(frozen=True)
    class Items:
        items: object

    class Odd(Action):
        def run(self) -> Steps[Items]:
            yield None
            return succeeded(Items(3))

    tree = play(main, leaves={**world.leaves(), "Odd": Odd})
    assert (tree.finish(), tree.reason) == ("FAILURE", "for_each goes through a list, got int")


@pytest.mark.parametrize("rounds", [1, 30])
def test_a_loop_of_instant_rounds_takes_one_tick_a_round(play: Any, rounds: int) -> None:
    tree = play(f"loop: {{max: {rounds}}}\ndo: {{set: {{a: 1}}}}")
    assert tree.finish() == "SUCCESS"
    assert tree.ticks == rounds + 1
