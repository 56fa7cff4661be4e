"""XML of BehaviorTree.CPP 4 as a mission: what it becomes, what is refused, and the way there and
back.
"""

from pathlib import Path
from typing import Any

import pytest
import yaml

from executive.tree.btcpp.import_xml import from_xml
from executive.tree.catalogue import InstalledCatalogue, TableCatalogue
from executive.tree.export import export
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.resolved import resolved_document, yaml_text
from executive.tree.sources import shipped_names


def given(name: str) -> Any:
    path = Path(__file__).parent / "imported" / f"{name}.yaml"
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def read(body: str, catalogue: Any = None, name: str = "given") -> Any:
    text = f'<root BTCPP_format="4">\n<BehaviorTree ID="main">\n{body}\n</BehaviorTree>\n</root>'
    return from_xml(text, "given.xml", catalogue or TableCatalogue({}), name)


def main_of(body: str, catalogue: Any = None) -> Any:
    return read(body, catalogue).document["trees"]["main"]


@pytest.mark.parametrize("name", shipped_names())
def test_a_shipped_mission_comes_back_from_xml_as_it_was(name: str, tmp_path: Path) -> None:
    mission = load_mission(name)
    written = export(mission, "xml")
    trees = from_xml(written, "it.xml", InstalledCatalogue(), name).document["trees"]
    path = tmp_path / "mission.yaml"
    path.write_text(yaml_text({**resolved_document(mission), "trees": trees}), encoding="utf-8")
    again = load_mission(str(path))
    assert export(again, "xml") == written
    assert (
        from_xml(export(again, "xml"), "it.xml", InstalledCatalogue(), name).document["trees"]
        == trees
    )


SAID = given("said")
UNSAID = given("unsaid")
FILES = given("files")


@pytest.mark.parametrize("case", SAID, ids=[case["xml"] for case in SAID])
def test_an_element_becomes_what_means_the_same(case: Any) -> None:
    assert main_of(case["xml"]) == case["becomes"]


@pytest.mark.parametrize("case", UNSAID, ids=[case["xml"] for case in UNSAID])
def test_what_cannot_be_said_is_told_with_its_line(case: Any) -> None:
    with pytest.raises(MissionFileError) as refused:
        read(f"<Sequence>\n<B/>\n{case['xml']}\n</Sequence>")
    assert str(refused.value).startswith("given.xml:5:")
    assert case["told"] in str(refused.value)


@pytest.mark.parametrize("case", FILES, ids=[case["xml"] for case in FILES])
def test_a_file_that_is_no_such_xml_is_refused(case: Any) -> None:
    with pytest.raises(MissionFileError) as refused:
        from_xml(case["xml"], "given.xml", TableCatalogue({}), "given")
    assert case["told"] in str(refused.value)


CALLS = """<root BTCPP_format="4" main_tree_to_execute="Main">
<BehaviorTree ID="Main"><Sequence>
  <Script code="a := 1"/>
  <SubTree ID="Doubles" x="{a}" y="{b}" z="4"/>
  <SubTree ID="Free" _autoremap="true"/>
</Sequence></BehaviorTree>
<BehaviorTree ID="Doubles"><Script code="y := x * 2; z += 1"/></BehaviorTree>
<BehaviorTree ID="Free"><Script code="c := b; _d := 1"/></BehaviorTree>
<TreeNodesModel><SubTree ID="Free">
  <input_port name="b" type="int"/><output_port name="c" type="std::vector&lt;int&gt;"/>
</SubTree></TreeNodesModel></root>"""


def test_ports_of_subtrees_follow_the_model_or_the_use_of_the_keys() -> None:
    with pytest.raises(MissionFileError, match="port 'z' is written by the tree, and given '4'"):
        from_xml(CALLS, "given.xml", TableCatalogue({}), "given")
    text = CALLS.replace('z="4"', 'z="{a}"')
    trees = from_xml(text, "given.xml", TableCatalogue({}), "given").document["trees"]
    assert list(trees) == ["main", "Doubles", "Free"]
    assert trees["main"]["sequence"][1:] == [
        {"call": "Doubles", "in": {"x": "{a}", "z": "{a}"}, "out": {"y": "{b}", "z": "{a}"}},
        {"call": "Free"},
    ]
    assert trees["Doubles"]["in"] == {"x": "object", "z": "object?"}
    assert trees["Doubles"]["out"] == {"y": "object", "z": "object"}
    assert (trees["Free"]["in"], trees["Free"]["out"]) == ({"b": "int"}, {"c": "object"})
    more = '<SubTree ID="Doubles" x="1" y="{b}" z="{a}"/></Sequence>'
    given_once = text.replace('x="{a}" ', "").replace("</Sequence>", more, 1)
    with pytest.raises(MissionFileError, match="the call of Doubles gives no port 'x'"):
        from_xml(given_once, "given.xml", TableCatalogue({}), "given")


def test_a_leaf_that_is_not_installed_is_told_and_kept() -> None:
    imported = read('<Sequence><Sleepp a="{b}"/></Sequence>')
    assert [str(one) for one in imported.warnings] == [
        "given.xml:3:11: warning: no behaviour 'Sleepp'; there is none: `executive check` "
        "refuses the mission until a plugin brings it"
    ]
    assert imported.document["trees"]["main"] == {
        "sequence": [{"run": "Sleepp", "in": {"a": "{b}"}}]
    }


def test_elements_nested_deeper_than_a_mission_can_hold_are_refused() -> None:
    deep = "<Sequence>" * 5000 + '<Sleep msec="5"/>' + "</Sequence>" * 5000
    with pytest.raises(MissionFileError, match="nested more than 25 elements deep"):
        read(deep)
    held = read("<Sequence>" * 20 + '<Sleep msec="5"/>' + "</Sequence>" * 20)
    assert "0.005" in yaml_text(held.document)


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("a := " + "(" * 60 + "1" + ")" * 60, "more than 100 signs"),
        ("a := " + "(" * 40 + "b" + ")" * 40, "nested more than 30 levels deep"),
        ("a := " + "-" * 40 + "b", "nested more than 30 levels deep"),
        ("a := " + "b + " * 5000 + "1", "more than 100 signs"),
        ("a := " + "9" * 5000, "too large"),
        ("a := 1e999", "too large"),
    ],
)
def test_scripts_without_end_are_refused(script: str, words: str) -> None:
    with pytest.raises(MissionFileError, match=words):
        read(f'<Script code="{script}"/>')


def test_a_number_may_begin_with_zeros() -> None:
    assert main_of('<Script code="a := 03"/>') == {"set": {"a": 3}}


def test_a_number_beyond_64_bits_is_refused() -> None:
    with pytest.raises(MissionFileError, match="msec has 400 digits; that is too large a number"):
        read(f'<Timeout msec="{"9" * 400}"><AlwaysSuccess/></Timeout>')
