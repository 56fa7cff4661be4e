"""Trees at random: the journal is whole, nothing is left under way,
and a second run is the same.
"""

import json
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from executive.config import Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.runtime import MissionFaultError

OPEN: set[int] = set()  # generators under way


class ActSettings(Settings):
    ticks: int = 0
    end: str = "succeed"


class Act(Action[ActSettings]):
    """Succeeds, fails or raises after some ticks."""

    def run(self) -> Steps[None]:
        key = id(self)
        assert key not in OPEN, "begun twice"
        OPEN.add(key)
        try:
            for _ in range(self.settings.ticks):
                yield None
            if self.settings.end == "raise":
                raise ArithmeticError("raised")
            return succeeded(reason="done") if self.settings.end == "succeed" else failed("failed")
        finally:
            OPEN.discard(key)


class Sometimes(Condition):
    """Holds at every other third of a second of the mission."""

    def check(self) -> Outcome[None]:
        clock = self.context.runtime.clock  # type: ignore[attr-defined]
        return succeeded() if int(clock.now_s() * 3) % 2 == 0 else failed("not now")


ends = st.sampled_from(["succeed", "succeed", "fail", "raise"])
act = st.builds(
    lambda t, e: {"run": "Act", "with": {"ticks": t, "end": e}}, st.integers(0, 4), ends
)
check = st.just({"check": "Sometimes"})
leaf = st.one_of(act, act, check, st.just({"wait": 0.2}), st.just({"set": {"a": 1}}))
condition = st.sampled_from(
    ["Sometimes", {"not": "Sometimes"}, {"any": ["Sometimes", {"not": "Sometimes"}]}]
)


def switch(node: Any, other: Any) -> Any:
    return {"switch": "{s}", "cases": {"1": node}, "else": other}


def while_else(node: Any, other: Any, condition: Any) -> Any:
    """Return a choice that is asked anew at each tick, for so long: it may change without end."""
    return {"do": {"while": condition, "do": node, "else": other}, "timeout": 1}


def consume(node: Any) -> Any:
    return {"consume": {"item": "x", "from": "{q}"}, "do": {"do": node}}


def composites(node: Any) -> Any:
    nodes = st.lists(node, min_size=1, max_size=3)
    return st.one_of(
        st.builds(lambda n: {"sequence": n}, nodes),
        st.builds(lambda n: {"fallback": n}, nodes),
        st.builds(lambda n: {"reactive_fallback": n}, nodes),
        st.builds(lambda n: {"reactive_sequence": [{"check": "Sometimes"}, n]}, node),
        st.builds(lambda n: {"reactive_sequence": n}, nodes),
        st.builds(lambda n: {"persistent_sequence": n}, nodes),
        st.builds(lambda n: {"not": n}, node),
        st.builds(lambda n: {"force_failure": n}, node),
        st.builds(lambda n, c: {"if": c, "then": n}, node, condition),
        st.builds(lambda n, m, c: {"if": c, "then": n, "else": m}, node, node, condition),
        st.builds(while_else, node, node, condition),
        st.builds(lambda n, m: {"sequence": [{"set": {"s": 1}}, switch(n, m)]}, node, node),
        st.builds(lambda n: {"sequence": [{"set": {"q": [1, 2]}}, consume(n)]}, leaf),
        st.builds(lambda n: {"parallel": n, "wait_for_all": True}, nodes),
        st.builds(lambda n, k: {"parallel": n, "fail": 1 + k % len(n)}, nodes, st.integers(0, 2)),
        st.builds(lambda n: {"loop": {"max": 2}, "do": {"do": n, "once": True}}, node),
        st.builds(lambda n: {"do": n, "on_halt": {"check": "Sometimes"}}, node),
        st.builds(lambda n: {"loop": "forever", "do": n, "timeout": 0.3}, node),
        st.builds(
            lambda n, k: {"parallel": n, "succeed": 1 + k % len(n)}, nodes, st.integers(0, 2)
        ),
        st.builds(lambda n, k: {"loop": {"max": k}, "do": n}, node, st.integers(1, 3)),
        st.builds(lambda n, c: {"loop": {"until": c, "max": 3}, "do": n}, node, condition),
        st.builds(lambda n: {"for_each": {"item": "x", "in": [1, 2]}, "do": {"do": n}}, leaf),
        st.builds(lambda n, k: {"do": n, "retry": k}, node, st.integers(1, 3)),
        st.builds(lambda n, r: {"do": n, "on_failure": r, "retry": 2}, node, node),
        st.builds(lambda n: {"do": n, "optional": True}, node),
        st.builds(lambda n, c: {"do": n, "if": c}, node, condition),
        st.builds(lambda n, c: {"do": n, "while": c}, node, condition),
        st.builds(lambda n: {"do": n, "timeout": 0.3}, node),
    )


trees = st.recursive(leaf, composites, max_leaves=12)
quick = settings(
    max_examples=100,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
LEAVES = {"Act": Act, "Sometimes": Sometimes}


def check_journal(lines: list[Any], is_over: bool) -> None:
    """Every start has its end, and nothing starts twice before that."""
    started: set[str] = set()
    for kind, node, payload in lines:
        if kind == "node_started":
            assert node not in started
            started.add(node)
        elif kind == "node_ended":
            assert payload["status"] in ("success", "failure", "halted", "skipped")
            started.discard(node)
    assert not is_over or not started


@quick
@given(tree=trees)
def test_a_tree_ends_with_a_whole_journal_and_nothing_under_way(play: Any, tree: Any) -> None:
    OPEN.clear()
    first = play(json.dumps(tree), leaves=LEAVES)
    first.runtime.can_do_without = True
    first.finish(limit=1000)
    check_journal(first.runtime.lines, is_over=True)
    assert not OPEN
    assert all(node.status.name != "RUNNING" for node in first.root.iterate())
    assert all(type(error) is ArithmeticError for error in first.runtime.errors)
    second = play(json.dumps(tree), leaves=LEAVES)
    second.runtime.can_do_without = True
    second.finish(limit=1000)
    assert second.runtime.lines == first.runtime.lines


@quick
@given(tree=trees, ticks=st.integers(1, 12), visits=st.integers(0, 8))
def test_a_tree_that_is_halted_anywhere_leaves_nothing_under_way(
    play: Any, tree: Any, ticks: int, visits: int
) -> None:
    OPEN.clear()
    halted = play(json.dumps(tree), leaves=LEAVES)
    halted.runtime.can_do_without = True
    halted.tick()
    while halted.status == "RUNNING" and halted.ticks < ticks:
        halted.tick()
    if halted.status == "RUNNING":  # cut the next tick off in its middle
        for _ in zip(range(visits), halted.root.tick(), strict=False):
            pass
    halted.halt()
    assert not OPEN
    check_journal(halted.runtime.lines, is_over=True)
    assert all(node.status.name == "INVALID" for node in halted.root.iterate())
    halted.finish(limit=1000)
    check_journal(halted.runtime.lines, is_over=True)
    assert not OPEN


@quick
@given(tree=trees)
def test_an_error_ends_any_tree_and_a_halt_leaves_nothing_under_way(play: Any, tree: Any) -> None:
    OPEN.clear()
    tried = play(json.dumps(tree), leaves=LEAVES)
    try:
        tried.finish(limit=1000)
    except MissionFaultError:
        assert len(tried.runtime.errors) == 1
    else:
        assert not tried.runtime.errors
    tried.halt()
    check_journal(tried.runtime.lines, is_over=True)
    assert not OPEN


def course(play: Any, tree: Any) -> list[str]:
    """Return the status of a tree at each tick."""
    tried = play(json.dumps(tree), leaves=LEAVES)
    tried.runtime.can_do_without = True
    seen = [tried.tick()]
    while seen[-1] == "RUNNING":
        assert tried.ticks < 1000, "the tree does not end"
        seen.append(tried.tick())
    return [*seen, str(tried.root.is_skipped)]


@quick
@given(tree=trees, asked=condition)
def test_turning_twice_and_choosing_between_equals_change_nothing(
    play: Any, tree: Any, asked: Any
) -> None:
    plain = course(play, tree)
    assert course(play, {"not": {"not": tree}}) == plain
    assert course(play, {"if": asked, "then": tree, "else": tree}) == plain
    assert course(play, {"parallel": [tree]}) == plain


@quick
@given(children=st.lists(trees, min_size=1, max_size=3))
def test_a_fallback_is_a_sequence_turned_around(play: Any, children: Any) -> None:
    turned = {"not": {"sequence": [{"not": child} for child in children]}}
    assert course(play, {"fallback": children}) == course(play, turned)
