"""Pictures of a tree: text, DOT, and XML that holds what BehaviorTree.CPP 4 asks for."""

import re
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml

from executive.config import Settings
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import succeeded
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
    "Sequence": set(), "Fallback": set(), "TryCatch": set(), "WhileDoElse": set(),
    "IfThenElse": set(), "SubTree": {"ID", "stone", "held"},
    "Parallel": {"success_count", "failure_count"}, "Repeat": {"num_cycles"}, "Timeout": {"msec"},
    "RetryUntilSuccessful": {"num_attempts"}, "ForceSuccess": set(),
    "Inverter": set(),
    "Sleep": {"msec"}, "Script": {"code"}, "AlwaysSuccess": {"_skipIf"},
}  # fmt: skip
CHILDREN = {
    **dict.fromkeys(("Repeat", "Timeout", "RetryUntilSuccessful", "ForceSuccess", "Inverter"), 1),
    "ForEach": 1,
    "LoopUntil": 2,
    "TryCatch": 2,
    "WhileDoElse": 2,
    "IfThenElse": 3,
    **dict.fromkeys(("SubTree", "Sleep", "Script", "AlwaysSuccess", "Scan", "Calm", "Ask"), 0),
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
            given = set(element.attrib) - {"name"}
            if element.tag in BUILT_IN:
                assert given <= BUILT_IN[element.tag], element.tag
            else:
                ports = {p.get("name") for p in models[element.tag] if p.tag.endswith("_port")}
                assert given <= ports, element.tag


def test_every_node_of_the_xml_has_as_many_children_as_it_takes(root: Any) -> None:
    for tree in root.findall("BehaviorTree"):
        for element in list(tree.iter())[1:]:
            assert len(element) == CHILDREN.get(element.tag, len(element)), element.tag


def test_xml_lays_modifiers_around_a_node_outermost_first(root: Any) -> None:
    scan = root.find("BehaviorTree/Sequence/Timeout")
    assert scan.get("msec") == "30000"
    assert [scan[0].tag, scan[0][0].tag, scan[0][0][0].tag] == [
        "RetryUntilSuccessful",
        "TryCatch",
        "TryCatch",
    ]
    action = scan[0][0][0][0]
    assert (action.tag, action.get("cloud"), action.get("label")) == (
        "Scan",
        "{cloud}",
        'a "quoted" <text>',
    )


def test_what_is_left_out_is_a_node_that_is_always_skipped(root: Any) -> None:
    guards = root.findall(".//IfThenElse")
    assert len(guards) == 2
    assert all(
        (guard[2].tag, guard[2].get("_skipIf")) == ("AlwaysSuccess", "true") for guard in guards
    )


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
    assert {"Consume", "Calm"} <= models
    assert top[7][0].get("_onHalted") == "a := 1"


def test_a_mission_with_every_node_loads_again_as_it_is_written_out(
    load: Any, catalogue: Any
) -> None:
    mission = load(NODES)
    written = resolved_yaml(mission)
    again = load("", header=written)
    assert resolved_yaml(again) == written
    jsonschema.Draft202012Validator(mission_schema(catalogue)).validate(yaml.safe_load(written))


@pytest.mark.parametrize(
    ("given", "written"),
    [("30 s", "30000"), ("0.0007 s", "1"), ("1.2344 s", "1234"), ("1.2346 s", "1235")],
)
def test_xml_gives_durations_in_whole_milliseconds(load: Any, given: str, written: str) -> None:
    mission = load(f"trees:\n  main: {{wait: {given}, timeout: {given}}}\n")
    root = ElementTree.fromstring(export(mission, "xml"))
    timeout = root.find("BehaviorTree/Timeout")
    assert (timeout.get("msec"), timeout[0].get("msec")) == (written, written)


AWKWARD = """
trees:
  main:
    sequence:
      - {check: Calm, name: calm}
      - {call: Sequence, name: twice}
      - {call: Sequence, name: twice}
      - {set: {n: 2, far: 1 km}}
      - {run: Sleep, with: {name: "{n} stones", depth: 0.05}}
      - {check: "{n} > 1 and not ({n} == 3 or {n} < -1)"}
      - {check: "len([1, 2]) > {n}", on_halt: {check: false}}
      - {do: {wait: 1 s, name: inner}, name: outer}
      - {check: true, if: false}
  Sequence: {run: Scan}
"""


class SleepSettings(Settings):
    name: str = ""
    depth: float = 0.1


class Sleep(Action[SleepSettings]):
    """A leaf with a name that BehaviorTree.CPP has taken."""

    def run(self) -> Steps[None]:
        yield None
        return succeeded()


def test_xml_keeps_clear_of_names_that_are_taken(load: Any) -> None:
    text = export(load(AWKWARD, leaves={"Sleep": Sleep}), "xml")
    root = ElementTree.fromstring(text)
    children = root.find("BehaviorTree/Sequence")
    assert [(c.tag, c.get("name")) for c in children][:3] == [
        ("Calm", "calm"),
        ("SubTree", "twice"),
        ("SubTree", "twice 2"),
    ]
    assert [tree.get("ID") for tree in root.findall("BehaviorTree")] == ["main", "Sequence_tree"]
    assert children[3].get("code") == "n := 2; far := 1000.0"
    assert children[4].attrib == {"name_": "{n} stones", "depth": "0.05"}
    assert children[4].tag == "Sleep_"
    assert children[5].get("code") == "n > 1 && !(n == 3 || n < -1)"
    assert [one.tag for one in children[6]] == ["Holds", "AlwaysFailure"]
    assert (children[7].get("name"), children[7][0].get("name")) == ("outer", "inner")
    assert children[8].attrib == {"_skipIf": "true"}
    models = {model.get("ID") for model in root.find("TreeNodesModel")}
    assert {"Sleep_", "Holds", "OnHalt", "Sequence_tree"} <= models
