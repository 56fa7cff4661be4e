"""What is laid around a node: if, while, timeout, retry, on_failure, optional, and their order."""

from typing import Any

import pytest

from executive.config import Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded


class TrySettings(Settings):
    needed: int = 1
    ticks: int = 0
    id: str = "Try"


class World:
    def __init__(self) -> None:
        self.log: list[str] = []
        self.is_open = True

    def leaves(self) -> dict[str, type]:
        world = self

        class Try(Action[TrySettings]):
            """Succeeds at the `needed`-th attempt."""

            def run(self) -> Steps[None]:
                world.log.append(self.settings.id)
                for _ in range(self.settings.ticks):
                    yield None
                attempts = world.log.count(self.settings.id)
                return (
                    succeeded(reason="there")
                    if attempts >= self.settings.needed
                    else failed(f"no. {attempts}")
                )

        class Open(Condition):
            def check(self) -> Outcome[None]:
                return succeeded() if world.is_open else failed("closed")

        return {"Try": Try, "Open": Open}


@pytest.fixture
def world() -> World:
    return World()


@pytest.fixture
def tree_of(play: Any, world: World) -> Any:
    return lambda main, **options: play(main, leaves=world.leaves(), **options)


def test_retry_counts_attempts_in_all_and_journals_each_further_one(
    tree_of: Any, world: World
) -> None:
    tree = tree_of("run: Try\nwith: {needed: 3}\nretry: 3")
    assert (tree.finish(), tree.reason) == ("SUCCESS", "attempt 3 of 3: there")
    assert [p for kind, _, p in tree.runtime.lines if kind == "node_retried"] == [
        {"attempt": 1, "of": 3, "reason": "no. 1"},
        {"attempt": 2, "of": 3, "reason": "no. 2"},
    ]


def test_retry_fails_with_the_last_reason_when_the_attempts_are_used_up(
    tree_of: Any, world: World
) -> None:
    tree = tree_of("retry: 2\ndo:\n  run: Try\n  with: {needed: 3}")
    assert (tree.finish(), tree.reason) == ("FAILURE", "no. 2 (2 attempts)")
    assert world.log == ["Try", "Try"]


def test_retry_pauses_by_the_missions_clock(tree_of: Any, world: World) -> None:
    tree = tree_of("run: Try\nwith: {needed: 2}\nretry: {attempts: 2, pause: 1 s}")
    tree.finish()
    assert tree.runtime.clock.now_s() == pytest.approx(
        1.1
    )  # the attempt after a pause of 10 ticks of 0.1 s


def test_retry_begins_to_count_anew_when_it_is_entered_again(tree_of: Any, world: World) -> None:
    tree = tree_of(
        "loop: {max: 2}\ndo:\n  optional: true\n  do:\n    run: Try\n    with: "
        "{needed: 9}\n    retry: 2"
    )
    assert tree.finish() == "SUCCESS"
    assert len(world.log) == 4


def test_timeout_cancels_by_the_missions_clock(tree_of: Any, world: World) -> None:
    tree = tree_of("run: Try\nwith: {ticks: 99}\ntimeout: 500 ms")
    assert (tree.finish(), tree.reason) == ("FAILURE", "not done within 0.5 s")
    assert tree.ticks == 6  # at 0.0, 0.1 … 0.5 s
    assert tree.runtime.endings() == [("main", "halted")]
    assert tree.runtime.told("node_timed_out") == ["main@timeout"]


def test_timeout_leaves_alone_what_ends_in_time(tree_of: Any, world: World) -> None:
    tree = tree_of("run: Try\nwith: {ticks: 4}\ntimeout: 500 ms")
    assert (tree.finish(), tree.reason) == ("SUCCESS", "there")


@pytest.mark.parametrize("limit", ["500 ms", "450 ms"])
def test_timeout_cancels_what_would_end_when_its_time_is_over(
    tree_of: Any, world: World, limit: str
) -> None:
    tree = tree_of(f"run: Try\nwith: {{ticks: 5}}\ntimeout: {limit}")
    assert tree.finish() == "FAILURE"
    assert tree.runtime.endings() == [("main", "halted")]


def test_if_leaves_the_node_out_of_a_sequence_and_says_so(tree_of: Any, world: World) -> None:
    world.is_open = False
    tree = tree_of("sequence:\n  - run: Try\n    if: Open\n  - run: Try\n    with: {id: after}")
    assert tree.finish() == "SUCCESS"
    assert world.log == ["after"]
    assert ("node_left_out", "main/0:Try@if", {"reason": "closed"}) in tree.runtime.lines


def test_if_is_asked_when_the_node_begins_and_not_again(tree_of: Any, world: World) -> None:
    tree = tree_of("run: Try\nwith: {ticks: 3}\nif: Open")
    tree.tick()
    world.is_open = False
    assert (tree.finish(), tree.reason) == ("SUCCESS", "there")


def test_a_node_left_out_of_a_fallback_makes_room_for_the_next(tree_of: Any, world: World) -> None:
    world.is_open = False
    tree = tree_of("fallback:\n  - run: Try\n    if: Open\n  - run: Try\n    with: {id: second}")
    assert tree.finish() == "SUCCESS"
    assert world.log == ["second"]


@pytest.mark.parametrize(
    ("condition", "runs"),
    [
        ('"{flag}"', True),
        ('{not: "{flag}"}', False),
        ('{all: [Open, "{flag}"]}', True),
        ('{all: [Open, {not: "{flag}"}]}', False),
        ('{any: [{not: Open}, "{flag}"]}', True),
        ("{any: [{not: Open}, {not: Open}]}", False),
        ("{check: Open}", True),
    ],
)
def test_conditions_combine(tree_of: Any, world: World, condition: str, runs: bool) -> None:
    tree = tree_of(f"sequence:\n  - set: {{flag: true}}\n  - run: Try\n    if: {condition}")
    assert tree.finish() == "SUCCESS"
    assert world.log == (["Try"] if runs else [])


def test_while_cancels_the_node_when_its_condition_no_longer_holds(
    tree_of: Any, world: World
) -> None:
    tree = tree_of("run: Try\nwith: {ticks: 9}\nwhile: Open")
    tree.tick(2)
    world.is_open = False
    assert (tree.tick(), tree.reason) == ("FAILURE", "no longer allowed: closed")
    assert tree.runtime.endings() == [("main", "halted")]


def test_on_failure_recovers_and_the_failure_stands(tree_of: Any, world: World) -> None:
    tree = tree_of(
        "run: Try\nwith: {needed: 9}\non_failure:\n  run: Try\n  with: {id: recovery, ticks: 2}"
    )
    assert (tree.finish(), tree.reason) == ("FAILURE", "no. 1")
    assert world.log == ["Try", "recovery"]
    assert ("main@on_failure/0:Try", "success") in tree.runtime.endings()


def test_on_failure_is_not_ticked_after_a_success(tree_of: Any, world: World) -> None:
    tree = tree_of("run: Try\non_failure:\n  run: Try\n  with: {id: recovery}")
    assert tree.finish() == "SUCCESS"
    assert world.log == ["Try"]


def test_a_recovery_that_fails_is_told_too(tree_of: Any, world: World) -> None:
    tree = tree_of(
        "run: Try\nwith: {needed: 9}\non_failure:\n  run: Try\n  with: {id: recovery, needed: 9}"
    )
    assert (tree.finish(), tree.reason) == ("FAILURE", "no. 1; recovery failed: no. 1")


def test_retry_lies_around_on_failure_so_that_each_attempt_is_recovered_from(
    tree_of: Any, world: World
) -> None:
    tree = tree_of(
        "run: Try\nwith: {needed: 3}\nretry: 3\non_failure:\n  run: Try\n  with: {id: recovery}"
    )
    assert tree.finish() == "SUCCESS"
    assert world.log == ["Try", "recovery", "Try", "recovery", "Try"]


def test_timeout_lies_around_retry(tree_of: Any, world: World) -> None:
    tree = tree_of("run: Try\nwith: {needed: 99, ticks: 2}\nretry: 50\ntimeout: 1 s")
    assert (tree.finish(), tree.reason) == ("FAILURE", "not done within 1 s")
    assert len(world.log) == 4  # an attempt takes three ticks of 0.1 s, and 11 ticks pass


def test_optional_turns_failure_into_success_and_keeps_the_reason(
    tree_of: Any, world: World
) -> None:
    tree = tree_of("run: Try\nwith: {needed: 9}\noptional: true")
    assert (tree.finish(), tree.reason) == ("SUCCESS", "no. 1")
    assert ("node_excused", "main@optional", {"reason": "no. 1"}) in tree.runtime.lines


def test_a_name_is_what_paths_say(tree_of: Any, world: World) -> None:
    tree = tree_of("sequence:\n  - run: Try\n    name: first look")
    tree.finish()
    assert tree.runtime.told("node_started") == ["main", "main/0:first look"]
