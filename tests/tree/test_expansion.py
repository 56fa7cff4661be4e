"""Trees that call each other: circles, chains and doublings are told before anything is built."""

from typing import Any

import pytest

from executive.tree import expansion
from executive.tree.problem import MissionFileError


def chain(length: int) -> str:
    """Return trees of which each calls the next."""
    links = "".join(f"  t{i}: {{call: t{i + 1}}}\n" for i in range(length))
    return f"trees:\n  main: {{call: t0}}\n{links}  t{length}: {{wait: 1 s}}\n"


def doubling(length: int) -> str:
    """Return trees of which each calls the next twice."""
    twice = "".join(
        f"  t{i}: {{sequence: [call: t{i + 1}, call: t{i + 1}]}}\n" for i in range(length)
    )
    return f"trees:\n  main: {{call: t0}}\n{twice}  t{length}: {{wait: 1 s}}\n"


def test_a_chain_of_calls_has_a_greatest_depth(load: Any) -> None:
    load(chain(90))
    for length in (300, 3000):
        with pytest.raises(MissionFileError, match="levels deep with its calls") as caught:
            load(chain(length))
        assert len(caught.value.problems) == 1


def test_a_kilobyte_that_doubles_is_refused_at_the_tree_that_is_too_large(load: Any) -> None:
    load(doubling(10))
    with pytest.raises(MissionFileError, match="nodes with its calls written out") as caught:
        load(doubling(30))
    assert len(caught.value.problems) == 1
    assert "each call is a copy" in str(caught.value)


def test_trees_of_the_greatest_depth_are_taken_and_one_level_more_is_refused(load: Any) -> None:
    load(chain(expansion.MAX_DEPTH - 2))  # below `main` and above the node that waits
    with pytest.raises(MissionFileError, match=f"is {expansion.MAX_DEPTH + 1} levels deep"):
        load(chain(expansion.MAX_DEPTH - 1))


def test_trees_of_the_greatest_size_are_taken_and_one_node_more_is_refused(
    load: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    nodes = 1 + 3 * (2**4 - 1) + 2**4  # main, a sequence and two calls each time, and the leaves
    monkeypatch.setattr(expansion, "MAX_NODES", nodes)
    load(doubling(4))
    monkeypatch.setattr(expansion, "MAX_NODES", nodes - 1)
    with pytest.raises(MissionFileError, match=f"has {nodes} nodes with its calls written out"):
        load(doubling(4))


def test_circles_are_told_together_with_what_else_is_wrong(load: Any) -> None:
    text = "trees:\n  main: {sequence: [call: a, wait: 5 kg]}\n  a: {call: b}\n  b: {call: a}\n"
    with pytest.raises(MissionFileError) as caught:
        load(text)
    told = [problem.message for problem in caught.value.problems]
    assert len(told) == 2
    assert any("in a circle: a → b → a" in one for one in told)
