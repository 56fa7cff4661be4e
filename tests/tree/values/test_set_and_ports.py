"""`set`, ports, checks and names that take expressions."""

from typing import Any

import pytest

from executive.interfaces.plugin import Plugin
from executive.tree.catalogue import TableCatalogue
from executive.tree.resolved import resolved_yaml
from executive.tree.schema import mission_schema
from tests.tree.values.leaves import LEAVES


def test_set_computes_and_a_loop_counts(run: Any) -> None:
    one = run(
        '- set: {n: 0}\n- loop: {until: "{n} >= 3", max: 9}\n  do: {set: {n: "{n} + 1"}}\n'
        "- set: {told: \"text('n is ', {n}, ', half is ', {n} / 2)\", far: 2 km}"
    )
    store = one.runtime.store
    assert (store.get("n"), store.get("told"), store.get("far")) == (3, "n is 3, half is 1.5", 2000)


def test_a_port_takes_an_expression(run: Any, told: Any) -> None:
    turn = '- check: See\n- run: Turn\n  with: {angle: 0}\n  in: {payload: "%s"}'
    assert run(turn % "{largest.mass_kg} / 2").runtime.store.get("mass") == 450
    assert told(turn.replace('"%s"', '§"%s"') % "text('a', {largest.id})") == [
        "§ input 'payload' of Turn is mass, and 'text('a', {largest.id})' holds str"
    ]


def test_an_optional_input_is_asked_for_before_it_is_read(run: Any, told: Any) -> None:
    trees = (
        "  show:\n    in: {rock: 'Rock?'}\n    out: {told: str}\n    fallback:\n"
        '      - {set: {told: "text({rock.id})"}, if: "has({rock})"}\n'
        "      - set: {told: nothing}\n"
    )
    given = '- check: See\n- call: show\n  in: {rock: "{largest}"}'
    assert told(given, trees) == []
    assert run(given, trees).runtime.store.get("told") == "2"
    assert told("- call: show", trees) == []
    assert run("- call: show", trees).runtime.store.get("told") == "nothing"


def test_a_resolved_mission_with_expressions_loads_as_the_same(load: Any, tmp_path: Any) -> None:
    text = (
        "trees:\n  main:\n    sequence:\n      - set: {heading: 10 deg}\n      - check: See\n"
        '      - run: Turn\n        with: {angle: "{heading}*2", label: "a {heading} b"}\n'
        '        in: {payload: "{largest.mass_kg}"}\n        if: "len({rocks})>1"\n'
    )
    mission = load(text, leaves=LEAVES)
    written = resolved_yaml(mission)
    assert (
        "'{heading} * 2'" in written or '"{heading} * 2"' in written or "{heading} * 2" in written
    )
    again = load(written, leaves=LEAVES, header="")
    assert resolved_yaml(again) == written


def test_a_check_takes_an_expression(run: Any) -> None:
    small, large = "'{largest.mass_kg} < 1 t'", "'{largest.mass_kg} > 1 t'"
    assert run(f"- check: See\n- check: {small}").status == "SUCCESS"
    refused = run(f"- check: See\n- check: {large}")
    assert refused.status == "FAILURE"
    assert refused.reason == "{largest.mass_kg} > 1 t is false ({largest.mass_kg} = 900)"
    broken = run("- check: See\n- check: '{rocks[7].id} > 1'")
    assert (broken.status, broken.runtime.errors) == ("FAILURE", [])


def test_an_expression_may_stand_before_the_last_child_of_a_reactive_sequence(run: Any) -> None:
    one = run(
        "- set: {n: 1}\n- reactive_sequence:\n    - check: '{n} < 3'\n    - wait: 0.3 s\n"
        "- reactive_fallback:\n    - check: '{n} > 3'\n    - wait: 0.3 s"
    )
    assert one.status == "SUCCESS", one.reason


def test_a_check_with_an_expression_takes_no_settings(told: Any) -> None:
    assert told("- check: See\n- check: '{largest.id} > 1'\n  §with: {a: 1}") == [
        "§ 'with' belongs to a leaf, not an expression"
    ]


def test_a_name_is_filled_in_when_the_node_begins_and_its_path_stays(run: Any, told: Any) -> None:
    one = run(
        "- check: See\n- for_each: {item: r, in: '{rocks}'}\n"
        "  do: {wait: 0.1 s, name: 'stone {r.id}'}"
    )
    node = next(node for node in one.root.iterate() if "stone" in node.path)
    assert node.name == "stone 2"
    assert node.path == "main/1:for_each/0:stone {r.id}"
    assert told("- wait: 1 s\n  name: 'stone {§r.id}'") == [
        "§ 'name' reads key 'r' before it is written; nothing is written before it"
    ]


def test_the_schema_takes_expressions_where_the_language_does() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    catalogue = TableCatalogue(LEAVES, {"robot": {"fake": Plugin}})
    validator = jsonschema.Draft202012Validator(mission_schema(catalogue))
    head = {"api": 1, "mission": "m"}

    def is_valid(node: dict[str, Any]) -> bool:
        return validator.is_valid({**head, "trees": {"main": {"sequence": [node]}}})

    assert is_valid({"run": "Turn", "with": {"angle": "{heading} * 2", "label": "a {b}"}})
    assert is_valid({"run": "Turn", "with": {"angle": 1}, "in": {"payload": "{a.b} / 2"}})
    assert is_valid({"check": "{a} > 1 m", "if": "len({b}) > 2"})
    assert is_valid({"ask": "Which?", "choices": ["a", "b"], "out": {"answer": "{side}"}})
    assert not is_valid({"run": "Turn", "with": {"angle": [1]}})
    assert not is_valid({"ask": "Which?", "choices": ["a"]})
