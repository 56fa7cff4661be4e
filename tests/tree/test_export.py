"""Pictures of a tree: text, DOT, and XML that holds what BehaviorTree.CPP 4 asks for."""

import re
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml

from executive.tree.export import export
from executive.tree.resolved import resolved_yaml
from executive.tree.schema import mission_schema

jsonschema = pytest.importorskip("jsonschema")

TREES = """
trees:
  main:
    sequence:
      - run: Scan
        with: {angle: 90 deg, label: "a \\"quoted\\" <text>"}
        timeout: 30 s
        retry: {attempts: 3, pause: 500 ms}
        on_failure: {wait: 2 s}
      - run: FindStones
      - for_each: {item: stone, in: "{stones}"}
        do:
          call: pick_one
          if: {all: [Calm, {not: {check: HasStones}}]}
          while: Calm
      - loop: {until: Calm, max: 3}
        do: {ask: "Go on?", default: true}
      - loop: {max: 2}
        do: {set: {a: 1, b: "{stones}"}}
      - fallback:
          - check: Calm
            if: HasStones
          - parallel: [{check: Calm}, {check: HasStones}]
            succeed: one
            optional: true
            name: both at once
  pick_one:
    in: {stone: Stone}
    out: {held: bool}
    run: Pick
"""

# What BehaviorTree.CPP 4 has built in, with the attributes that each takes besides its name.
BUILT_IN = {
    "Sequence": set(), "Fallback": set(), "ReactiveSequence": set(), "ReactiveFallback": set(),
    "IfThenElse": set(),
    "Parallel": {"success_count", "failure_count"}, "Repeat": {"num_cycles"}, "Timeout": {"msec"},
    "RetryUntilSuccessful": {"num_attempts"}, "ForceSuccess": set(), "ForceFailure": set(),
    "Inverter": set(),
    "Sleep": {"msec"}, "SetBlackboard": {"value", "output_key"}, "AlwaysSuccess": set(),
    "ScriptCondition": {"code"},
}  # fmt: skip
ONE_CHILD = {
    "Repeat",
    "Timeout",
    "RetryUntilSuccessful",
    "ForceSuccess",
    "ForceFailure",
    "Inverter",
    "ForEach",
}
NO_CHILD = {
    "Action",
    "Condition",
    "SubTree",
    "Sleep",
    "SetBlackboard",
    "AlwaysSuccess",
    "ScriptCondition",
}


@pytest.fixture
def mission(load: Any) -> Any:
    return load(TREES)


@pytest.fixture
def root(mission: Any) -> Any:
    return ElementTree.fromstring(export(mission, "xml"))


def test_text_shows_every_node_with_its_modifiers_and_wires(mission: Any) -> None:
    text = export(mission, "text")
    assert "|-- run Scan  [timeout 30 s, retry 3 every 0.5 s]  cloud -> {cloud}" in text
    assert "|   `-- on failure: wait 2 s" in text
    assert (
        "|   `-- call pick_one  [if (Calm and not HasStones), while Calm]  stone <- "
        "{stone}; held -> {held}" in text
    )
    assert "|-- loop until Calm, at most 3 rounds" in text
    assert "    `-- parallel, 1 of 2 (both at once)  [optional]" in text
    assert "pick_one (in stone: Stone; out held: bool)" in text
    assert text.isascii()


def test_dot_is_a_graph_whose_edges_join_its_nodes(mission: Any) -> None:
    dot = export(mission, "dot")
    nodes = set(re.findall(r"^\s+(n\d+) \[label=", dot, re.MULTILINE))
    edges = re.findall(r"(n\d+) -> (n\d+)", dot)
    assert len(edges) == len(nodes) - 2  # two trees
    assert {end for edge in edges for end in edge} <= nodes


def test_xml_begins_with_the_main_tree_and_its_format(root: Any) -> None:
    assert root.attrib == {"BTCPP_format": "4", "main_tree_to_execute": "main"}
    assert [tree.get("ID") for tree in root.findall("BehaviorTree")] == ["main", "pick_one"]
    assert all(len(tree) == 1 for tree in root.findall("BehaviorTree"))


def test_every_node_of_the_xml_is_built_in_or_has_a_model_with_its_ports(root: Any) -> None:
    models = {model.get("ID"): model for model in root.find("TreeNodesModel")}
    for tree in root.findall("BehaviorTree"):
        for element in list(tree.iter())[1:]:
            name = element.get("ID") or element.tag
            given = set(element.attrib) - {"ID", "name"}
            if name in BUILT_IN:
                assert given == BUILT_IN[name], name
            else:
                ports = {p.get("name") for p in models[name] if p.tag.endswith("_port")}
                assert given <= ports, name
                assert models[name].tag in (element.tag, "Decorator", "Control"), name


def test_every_node_of_the_xml_has_as_many_children_as_it_takes(root: Any) -> None:
    for tree in root.findall("BehaviorTree"):
        for element in list(tree.iter())[1:]:
            if element.tag in ONE_CHILD:
                assert len(element) == 1, element.tag
            elif element.tag in NO_CHILD:
                assert len(element) == 0, element.tag
            else:
                assert len(element) >= 1, element.tag


def test_xml_lays_modifiers_around_a_node_outermost_first(root: Any) -> None:
    scan = root.find("BehaviorTree/Sequence/Timeout")
    assert scan.get("msec") == "30000"
    assert [scan[0].tag, scan[0][0].tag, scan[0][0][0].tag] == [
        "RetryUntilSuccessful",
        "Fallback",
        "Fallback",
    ]
    action = scan[0][0][0][0]
    assert (action.get("ID"), action.get("cloud"), action.get("label")) == (
        "Scan",
        "{cloud}",
        'a "quoted" <text>',
    )


def test_a_guarded_branch_of_a_fallback_fails_when_it_is_left_out(root: Any) -> None:
    guards = root.findall(".//IfThenElse")
    assert [len(guard) for guard in guards] == [
        3,
        2,
    ]  # in a loop's body: else success; in a fallback: none
    assert guards[0][2].tag == "AlwaysSuccess"


def test_models_carry_types_defaults_and_descriptions(root: Any) -> None:
    scan = root.find("TreeNodesModel/Action[@ID='Scan']")
    angle = scan.find("input_port[@name='angle']")
    assert (angle.get("default"), angle.text) == ("1.0", "Angle [rad].")
    assert scan.find("output_port[@name='cloud']").get("type") == "Cloud"
    assert (
        scan.find("MetadataFields/Metadata").get("description")
        == "Take `duration` and give a cloud."
    )


NODES = """
trees:
  main:
    persistent_sequence:
      - {set: {size: large, queue: [1]}}
      - {not: {check: Calm}}
      - {force_failure: {check: Calm}, once: true}
      - {if: Calm, then: {wait: 1 s}, else: {wait: 2 s}}
      - {while: Calm, do: {wait: 1 s}, else: {wait: 2 s}}
      - {switch: "{size}", cases: {large: {wait: 1 s}}}
      - switch: "{size}"
        cases: {a: &, b: &, c: &, d: &, e: &, f: &, g: &, h: &}
        else: {wait: 2 s}
      - {consume: {item: one, from: "{queue}"}, do: {wait: 1 s, on_halt: {set: {a: 1}}}}
      - {parallel: [{check: Calm}, {wait: 1 s}, {wait: 2 s}], succeed: one, fail: 2}
      - {parallel: [{check: Calm}, {wait: 1 s}], wait_for_all: true}
      - {loop: forever, do: {wait: 1 s}}
""".replace("&", "{wait: 1 s}")


def test_text_and_dot_show_branches_with_what_leads_to_them(load: Any) -> None:
    mission = load(NODES)
    text = export(mission, "text")
    for line in (
        "persistent_sequence",
        "|-- force_failure  [once]",
        "|   |-- then: wait 1 s",
        "|   `-- else: wait 2 s",
        "|   |-- do: wait 1 s",
        "|-- switch {size}",
        "|   `-- large: wait 1 s",
        "|-- consume one from {queue}",
        "|       `-- on halt: set a = 1",
        "|-- parallel, 1 of 3, fails with 2",
        "|-- parallel, waits for all",
        "`-- loop forever",
    ):
        assert line in text, line
    assert '[label="large", style=dashed]' in export(mission, "dot")


def test_xml_has_the_counterparts_of_branches_and_the_models_of_own_nodes(load: Any) -> None:
    root = ElementTree.fromstring(export(load(NODES), "xml"))
    top = root.find("BehaviorTree/SequenceWithMemory")
    assert [child.tag for child in top] == [
        "Sequence",
        "Inverter",
        "RunOnce",
        "IfThenElse",
        "WhileDoElse",
        "Switch2",
        "Switch6",
        "Consume",
        "Parallel",
        "ParallelAll",
        "Repeat",
    ]
    assert [child.tag for child in top[5]] == ["Sleep", "Sleep", "AlwaysFailure"]
    assert top[6].attrib == {
        "variable": "{size}",
        **{f"case_{number}": name for number, name in enumerate("abcdef", 1)},
    }
    assert (len(top[6]), top[6][6].tag, len(top[6][6])) == (7, "Switch2", 3)
    assert (top[8].get("success_count"), top[8].get("failure_count")) == ("1", "2")
    assert (top[9].get("max_failures"), top[10].get("num_cycles")) == ("1", "-1")
    models = {model.get("ID") for model in root.find("TreeNodesModel")}
    assert {"Consume", "OnHalt", "Calm"} <= models


def test_a_mission_with_every_node_loads_again_as_it_is_written_out(
    load: Any, catalogue: Any
) -> None:
    mission = load(NODES)
    written = resolved_yaml(mission)
    again = load("", header=written)
    assert resolved_yaml(again) == written
    jsonschema.Draft202012Validator(mission_schema(catalogue)).validate(yaml.safe_load(written))
