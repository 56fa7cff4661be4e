"""Several plugins of one capability by name: read, laid over, chosen, written out, refused."""

import pytest

from executive.config import Settings
from executive.interfaces.placing import PlacementPlanner
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, succeeded
from executive.tree.catalogue import TableCatalogue
from executive.tree.export import export
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.resolved import resolved_yaml

from .conftest import LEAVES, PLUGINS


class CountSettings(Settings):
    count: int = 1


class Rows(PlacementPlanner):
    Settings = CountSettings


class Wall(PlacementPlanner):
    Settings = CountSettings


class Lay(Condition):
    needs = (PlacementPlanner,)

    def check(self) -> Outcome[None]:
        return succeeded()


HEADER = """
api: 1
mission: test
plugins:
  robot: mujoco
  estimation: gnss_imu
  mapping: voxel_map
  placing: {rows: {plugin: rows, count: 7}, wall: {plugin: wall}}
trees:
  main:
    sequence:
"""
CHOSEN = "      - {check: Lay, use: rows}\n      - {check: Lay, use: {placing: wall}}\n"


@pytest.fixture
def load(tmp_path):
    known = TableCatalogue(
        {**LEAVES, "Lay": Lay}, {**PLUGINS, "placing": {"rows": Rows, "wall": Wall}}
    )

    def load_text(text, *overrides, base=None):
        if base is not None:
            (tmp_path / "base.yaml").write_text(base, encoding="utf-8")
        path = tmp_path / "mission.yaml"
        path.write_text(text, encoding="utf-8")
        return load_mission(str(path), overrides, known)

    return load_text


def told(load, *args, **more):
    with pytest.raises(MissionFileError) as refused:
        load(*args, **more)
    return [problem.message for problem in refused.value.problems]


def test_each_plugin_has_its_own_settings_under_its_name(load):
    plugins = load(HEADER + CHOSEN).plugins
    assert [key for key in plugins if key.startswith("placing")] == ["placing.rows", "placing.wall"]
    assert plugins["placing.rows"][0].settings.count == 7
    assert plugins["placing.wall"][0].settings.count == 1


def test_leaves_choose_by_name_or_by_capability_and_name(load):
    rows, wall = load(HEADER + CHOSEN).trees["main"].root.children()
    assert (rows.kind.use.uses, wall.kind.use.uses) == ({"placing": "rows"}, {"placing": "wall"})


def test_a_mission_written_out_loads_again(load):
    first = load(HEADER + CHOSEN)
    assert resolved_yaml(load(resolved_yaml(first))) == resolved_yaml(first)


def test_pictures_show_the_choice(load):
    mission = load(HEADER + CHOSEN)
    text = export(mission, "text")
    assert "placing.rows  rows" in text
    assert "check Lay, use placing.wall" in text
    assert "use placing.rows" in export(mission, "dot")


def test_settings_are_set_by_name(load):
    mission = load(HEADER + CHOSEN, "placing.rows.count=9", "placing.wall.plugin=rows")
    assert mission.plugins["placing.rows"][0].settings.count == 9
    assert mission.plugins["placing.wall"][0].name == "rows"


def test_a_layer_changes_adds_and_replaces_by_name(load):
    base = HEADER.replace("mission: test", "mission: base") + CHOSEN
    over = (
        "api: 1\nmission: test\nextends: base\nplugins: {placing: {rows: {count: 3}, "
        "wall: {plugin: rows}, more: {plugin: wall, count: 2}}}\n"
    )
    plugins = load(over, base=base).plugins
    found = {key: (one.name, one.settings.count) for key, (one,) in plugins.items() if "." in key}
    assert found == {
        "placing.rows": ("rows", 3),
        "placing.wall": ("rows", 1),
        "placing.more": ("wall", 2),
    }


def test_names_take_the_place_of_a_single_plugin_and_back(load):
    single = HEADER.replace("{rows: {plugin: rows, count: 7}, wall: {plugin: wall}}", "rows")
    over = "api: 1\nmission: test\nextends: base\nplugins: {placing: %s}\n"
    trees = "trees: {main: {sequence: [{check: Lay, use: a}, {check: Calm}]}}\n"
    named = load(over % "{a: {plugin: wall}}" + trees, base=single + "      - check: Lay\n")
    assert "placing" not in named.plugins
    plain = "trees: {main: {check: Lay}}\n"
    assert "placing" in load(over % "wall" + plain, base=HEADER + CHOSEN).plugins


def test_the_default_needs_no_choice(load):
    mission = load(HEADER.replace("rows: {", "default: {") + "      - check: Lay\n")
    assert mission.trees["main"].root.children()[0].kind.use.uses == {}


def test_a_choice_at_a_call_holds_in_the_trees_below(load):
    below = "      - {call: lay, use: wall}\n  lay: {call: one}\n  one: {check: Lay}\n"
    assert load(HEADER + below)
    (found,) = told(load, HEADER + below.replace(", use: wall", ""))
    assert found == (
        "Lay uses a placing plugin, and the mission has several: rows, wall; choose one with "
        "'use: rows' here or where the tree is called, or name one of them 'default'"
    )


def test_a_tree_that_is_called_twice_under_one_choice_is_told_once(load):
    twice = "      - {call: lay}\n      - {call: lay}\n  lay: {check: Lay}\n"
    (found,) = told(load, HEADER + twice)
    assert found.startswith("Lay uses a placing plugin, and the mission has several")


def test_a_choice_below_goes_over_that_of_the_call(load):
    tree = "      - {call: lay, use: wall}\n  lay: {check: Lay, use: rows}\n"
    assert load(HEADER + tree).trees["lay"].root.kind.use.uses == {"placing": "rows"}


@pytest.mark.parametrize(
    ("node", "message"),
    [
        ("{check: Lay, use: row}", "no plugin 'row' for Lay. Did you mean 'rows'?"),
        (
            "{check: Lay, use: {placing: wal}}",
            "no placing plugin is called 'wal'. Did you mean 'wall'?",
        ),
        (
            "{check: Lay, use: {placng: wall}}",
            "Lay uses no placng plugin that has a name in this mission. Did you mean 'placing'?",
        ),
        (
            "{check: Lay, use: [rows]}",
            "'use' takes a name or {capability: name}, not a list",
        ),
        (
            "{run: Scan, use: rows}",
            "Scan uses no capability whose plugins have names in this mission",
        ),
        (
            "{sequence: [{check: Lay, use: rows}], use: rows}",
            "a 'sequence' node has no 'use'",
        ),
    ],
)
def test_a_wrong_choice_is_one_mistake_with_its_cure(load, node, message):
    found = told(load, f"{HEADER}      - {node}\n")
    assert len(found) == 1
    assert found[0].startswith(message)


@pytest.mark.parametrize(
    ("plugins", "message"),
    [
        (
            "mapping: {a: {plugin: voxel_map}}",
            "mapping takes one plugin, without a name: the mission itself uses it",
        ),
        (
            "mapping: voxel_map\n  monitoring: {a: {plugin: jaw_slip}}",
            "monitoring takes a list of plugins, without names: all of them are used",
        ),
        (
            "mapping: voxel_map\n  placing: {rows: {plugin: rows}, wall: {count: 2}}",
            "placing needs 'plugin: name'",
        ),
        (
            "mapping: voxel_map\n  placing: {rows: {plugin: rws}}",
            "no placing plugin 'rws'. Did you mean 'rows'?",
        ),
    ],
)
def test_wrong_names_are_refused(load, plugins, message):
    head = HEADER.partition("  mapping:")[0] + f"  {plugins}\n" + "trees: {main: {check: Calm}}\n"
    found = told(load, head)
    assert any(one.startswith(message) for one in found), found


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (
            "placing.row.count=2",
            "the placing plugins have names: write placing.NAME.field, no 'row'. Did you mean",
        ),
        ("placing.count=2", "the placing plugins have names"),
        ("placing.rows.cont=2", "rows has no setting 'cont'. Did you mean 'count'?"),
    ],
)
def test_a_wrong_path_of_a_setting_is_refused(load, option, message):
    (found,) = told(load, HEADER + CHOSEN, option)
    assert found.startswith(message)
