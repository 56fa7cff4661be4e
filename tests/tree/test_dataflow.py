"""Keys through a tree: what may have been written, and as what; what must fail is told, what may
work is not.
"""

from typing import Any

import pytest

from executive.tree.port_types import fits, fits_name, holds
from executive.tree.problem import MissionFileError


def problems(load: Any, main: str, trees: str = "") -> list[str]:
    """Return the messages of a mission whose `main` is a sequence of these nodes."""
    body = "".join(f"      {line}\n" for line in main.strip("\n").splitlines())
    try:
        load(f"trees:\n  main:\n    sequence:\n{body}{trees}")
    except MissionFileError as error:
        return [problem.message for problem in error.problems]
    return []


FIND = "- run: Scan\n- run: FindStones\n"
PICK = '- run: Pick\n  in: {stone: "{one}"}\n'


def test_a_key_that_any_branch_of_a_fallback_writes_may_be_read(load: Any) -> None:
    assert (
        problems(load, "- fallback:\n    - check: Calm\n    - run: Scan\n- run: FindStones") == []
    )


def test_what_a_failed_branch_may_have_written_may_be_read_by_the_next(load: Any) -> None:
    assert problems(load, "- fallback:\n    - run: Scan\n    - run: FindStones") == []


def test_a_recovery_may_read_what_failed_may_have_written_and_not_what_comes_later(
    load: Any,
) -> None:
    assert problems(load, "- run: Scan\n  on_failure: {run: FindStones}") == []
    told = problems(load, "- wait: 1 s\n  on_failure: {run: FindStones}\n- run: Scan")
    assert told == [
        "input 'cloud' of FindStones reads key 'cloud' before it is written; 'Scan' at "
        "line 9 writes it, and never before this"
    ]


def test_a_node_behind_if_or_optional_may_have_written(load: Any) -> None:
    assert problems(load, "- run: Scan\n  if: Calm\n- run: FindStones") == []
    assert problems(load, "- run: Scan\n  optional: true\n- run: FindStones") == []


def test_a_condition_is_asked_before_its_node(load: Any) -> None:
    told = problems(load, "- run: Scan\n  if: HasStones\n- run: FindStones")
    assert told == [
        "input 'stones' of HasStones reads key 'stones' before it is written; 'FindStones' at "
        "line 9 writes it, and never before this"
    ]


def test_a_loops_body_may_have_written_after_the_loop_and_its_condition_is_asked_first(
    load: Any,
) -> None:
    assert problems(load, "- loop: {until: Calm}\n  do: {run: Scan}\n- run: FindStones") == []
    told = problems(load, "- run: Scan\n- loop: {until: HasStones}\n  do: {run: FindStones}")
    assert told == [
        "input 'stones' of HasStones reads key 'stones' before it is written; 'FindStones' at "
        "line 9 writes it, and never before this"
    ]


def test_an_item_is_known_in_the_body_and_not_after_it(load: Any) -> None:
    each = (
        FIND + '- for_each: {item: one, in: "{stones}"}\n  do:\n    run: Pick\n    in: '
        '{stone: "{one}"}\n'
    )
    assert problems(load, each) == []
    assert "before it is written" in problems(load, each + PICK)[0]


def test_an_item_that_is_no_stone_is_refused_where_a_stone_is_wanted(load: Any) -> None:
    told = problems(
        load,
        '- for_each: {item: one, in: [1, 2]}\n  do:\n    run: Pick\n    in: {stone: "{one}"}\n',
    )
    assert told == ["input 'stone' of Pick is Stone, and key 'one' holds int"]


def test_a_later_write_replaces_the_type_and_one_in_a_branch_adds_to_it(load: Any) -> None:
    over = "- run: Scan\n- set: {cloud: 3}\n- run: FindStones"
    assert problems(load, over) == [
        "input 'cloud' of FindStones is Cloud, and key 'cloud' holds int"
    ]
    maybe = "- run: Scan\n- set: {cloud: 3}\n  if: Calm\n- run: FindStones"
    assert problems(load, maybe) == []


def test_a_copy_keeps_the_type(load: Any) -> None:
    told = problems(load, FIND + '- set: {copy: "{stones}"}\n- run: Pick\n  in: {stone: "{copy}"}')
    assert told == ["input 'stone' of Pick is Stone, and key 'copy' holds list[Stone]"]


def test_an_optional_input_is_checked_only_if_it_is_connected(load: Any) -> None:
    each = FIND + '- for_each: {item: stone, in: "{stones}"}\n  do: {run: Pick}\n'
    assert problems(load, each) == []
    assert problems(load, "- set: {tool: 5}\n" + each) == [
        "input 'tool' of Pick is str, and key 'tool' holds int"
    ]


def test_a_tree_is_followed_with_the_types_that_it_is_called_with(load: Any) -> None:
    trees = (
        "  use:\n    in: {thing: object}\n    sequence:\n      - run: FindStones\n        "
        'in: {cloud: "{thing}"}\n'
    )
    assert problems(load, '- run: Scan\n- call: use\n  in: {thing: "{cloud}"}', trees) == []
    told = problems(load, "- call: use\n  in: {thing: 5}", trees)
    assert told == ["input 'cloud' of FindStones is Cloud, and key 'thing' holds int"]


def test_what_a_tree_gives_out_is_known_to_its_caller(load: Any) -> None:
    trees = (
        '  look:\n    out: {stones: "list[Stone]"}\n    sequence:\n      - run: Scan\n     '
        " - run: FindStones\n"
    )
    assert (
        problems(
            load,
            '- call: look\n  out: {stones: "{found}"}\n- check: HasStones\n  in: '
            '{stones: "{found}"}',
            trees,
        )
        == []
    )
    assert "before it is written" in problems(load, "- call: look\n- run: FindStones", trees)[0]


def test_an_action_is_named_that_could_write_what_no_node_writes(load: Any) -> None:
    assert problems(load, "- wait: 1 s\n- run: FindStones") == [
        "input 'cloud' of FindStones reads key 'cloud' before it is written; Scan writes it: put "
        "that before"
    ]


def test_an_output_of_another_type_than_a_tree_promises_is_refused(load: Any) -> None:
    trees = "  look:\n    out: {cloud: Stone}\n    run: Scan\n"
    assert problems(load, "- call: look", trees) == [
        "output 'cloud' is Stone, and Cloud is written"
    ]


def test_a_required_input_of_a_tree_must_be_there_and_an_optional_one_need_not(load: Any) -> None:
    trees = "  use:\n    in: {number: int%s}\n    wait: 1 s\n"
    told = problems(load, "- call: use", trees % "")
    assert told == [
        "input 'number' of use reads key 'number' before it is written; nothing is "
        "written before it"
    ]
    assert problems(load, "- call: use", trees % "?") == []


def test_trees_that_are_called_from_many_places_are_followed_in_good_time(load: Any) -> None:
    levels = "".join(
        f"  t{n}: {{sequence: [{{call: t{n + 1}}}, {{call: t{n + 1}}}]}}\n" for n in range(15)
    )
    assert problems(load, "- call: t0", levels + "  t15: {wait: 1 s}\n") == []


class Base: ...


class Derived(Base): ...


@pytest.mark.parametrize(
    ("have", "wanted", "answer"),
    [
        (Derived, Base, True), (Base, Derived, False), (int, float, True), (bool, int, False),
        (float, int, False),
        (list[Derived], list[Base], True), (list[Base], list[Derived], False), (list, list[Base],
        True),
        (list[Base], Base, False), (Base, object, True), (object, Base, True), (Any, Base, True),
        (Base | None, Base, True), (Base, Base | None, True), (int, str | None, False),
        (dict[str, int], dict, True),
    ],
)  # fmt: skip
def test_a_type_fits_another(have: Any, wanted: Any, answer: bool) -> None:
    assert fits(have, wanted) is answer


@pytest.mark.parametrize(
    ("have", "name", "answer"),
    [
        (Derived, "Base", True), (Base, "Derived", False), (list[Derived], "list[Base]", True),
        (int, "float", True),
        (list[int], "list[Base]", False), (Base, "list[Base]", False), (Base, "object", True),
        (Any, "Base", True),
        (Base | None, "Base", True), (list, "list[Base]", True),
    ],
)  # fmt: skip
def test_a_type_fits_a_types_name(have: Any, name: str, answer: bool) -> None:
    assert fits_name(have, name) is answer


@pytest.mark.parametrize(
    ("value", "wanted", "answer"),
    [
        (Derived(), Base, True), (3, float, True), (True, int, False), (True, bool, True),
        ([Derived()], list[Base], True),
        ([3], list[Base], False), (None, Base | None, True), (None, Base, False), (3, object,
        True), ((), list, False),
    ],
)  # fmt: skip
def test_a_value_is_of_a_type(value: Any, wanted: Any, answer: bool) -> None:
    assert holds(value, wanted) is answer
