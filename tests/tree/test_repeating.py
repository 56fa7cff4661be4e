"""Loops and for_each."""

from dataclasses import dataclass
from typing import Any

import pytest

from executive.config import Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.tree.rounds import ROUNDS_IN_A_TICK

COUNT = [0]


class CountSettings(Settings):
    needed: int = 1


def counted() -> dict[str, type]:
    """Return an action that ends at once and fails until it was begun `needed` times."""
    COUNT[0] = 0

    class Count(Action[CountSettings]):
        def run(self) -> Steps[None]:
            yield from ()
            COUNT[0] += 1
            return succeeded() if COUNT[0] >= self.settings.needed else failed("not yet")

    return {"Count": Count}


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
def test_instant_rounds_cost_no_tick(play: Any, rounds: int) -> None:
    tree = play(f"loop: {{max: {rounds}}}\ndo: {{set: {{a: 1}}}}")
    assert (tree.tick(), tree.ticks) == ("SUCCESS", 1)


def test_a_hundred_instant_items_cost_no_tick(play: Any) -> None:
    main = f"for_each: {{item: one, in: {list(range(100))}}}\ndo: {{set: {{a: 1}}}}"
    assert play(main).tick() == "SUCCESS"


def test_a_round_that_took_time_is_followed_by_the_next_at_the_next_tick(play: Any) -> None:
    world = World()
    tree = play("loop: {max: 2}\ndo: {run: Work}", leaves=world.leaves())
    seen = []
    while tree.tick() == "RUNNING":
        seen.append(len(world.seen))
    assert seen == [1, 1, 2, 2]


def test_the_rounds_of_one_tick_are_bounded_and_go_on_at_the_next(play: Any) -> None:
    tree = play(f"loop: {{max: {ROUNDS_IN_A_TICK + 5}}}\ndo: {{set: {{a: 1}}}}")
    assert (tree.tick(), tree.reason) == (
        "RUNNING",
        f"round {ROUNDS_IN_A_TICK + 1} of at most {ROUNDS_IN_A_TICK + 5}",
    )
    assert tree.tick() == "SUCCESS"


def test_loops_inside_one_another_share_the_bound(play: Any) -> None:
    tree = play("loop: forever\ndo:\n  loop: {max: 10}\n  do: {run: Count}", leaves=counted())
    tree.tick(3)
    assert 0 < COUNT[0] <= 3 * ROUNDS_IN_A_TICK


def test_a_loop_forever_ends_with_its_first_failing_round(play: Any) -> None:
    world = World()
    main = 'sequence:\n  - set: {n: bad}\n  - loop: forever\n    do: {run: Work, in: {item: "{n}"}}'
    tree = play(main, leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("FAILURE", "bad item")


def test_a_loop_forever_goes_on_until_it_is_halted(play: Any) -> None:
    world = World()
    tree = play("loop: forever\ndo: {run: Work}", leaves=world.leaves())
    assert tree.tick(20) == "RUNNING"
    tree.halt()
    assert len(world.seen) == 10


def test_an_attempt_that_failed_at_once_is_followed_by_the_next_in_the_same_tick(play: Any) -> None:
    tree = play("run: Count\nwith: {needed: 3}\nretry: 3", leaves=counted())
    assert (tree.tick(), COUNT[0]) == ("SUCCESS", 3)


CONSUME = """
sequence:
  - set: {queue: [a, b]}
  - consume: {item: item, from: "{queue}"}
    do: {run: Work}
"""


def test_consume_takes_one_item_after_the_other_until_the_list_is_empty(play: Any) -> None:
    world = World()
    tree = play(CONSUME, leaves=world.leaves())
    assert (tree.finish(), tree.runtime.store.get("queue")) == ("SUCCESS", [])
    assert world.seen == ["a", "b"]


def test_consume_takes_what_is_appended_while_it_runs(play: Any) -> None:
    world = World()
    tree = play(CONSUME, leaves=world.leaves())
    tree.tick()
    tree.runtime.store.set("queue", [*tree.runtime.store.get("queue"), "c"])
    assert tree.finish() == "SUCCESS"
    assert world.seen == ["a", "b", "c"]


def test_consume_fails_with_its_body_and_leaves_the_rest_on_the_list(play: Any) -> None:
    world = World()
    tree = play(CONSUME.replace("[a, b]", "[bad, b]"), leaves=world.leaves())
    assert (tree.finish(), tree.reason) == ("FAILURE", "bad item")
    assert tree.runtime.store.get("queue") == ["b"]


def test_a_halted_consume_leaves_what_it_has_not_begun_on_the_list(play: Any) -> None:
    world = World()
    tree = play(CONSUME, leaves=world.leaves())
    tree.tick()
    tree.halt()
    assert (world.seen, tree.runtime.store.get("queue")) == (["a"], ["b"])
