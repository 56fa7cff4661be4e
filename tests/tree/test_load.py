"""Loading: names, layers, overrides, subtrees in other files, and a mission written out."""

from pathlib import Path
from typing import Any

import pytest

from executive.tree.catalogue import Catalogue
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.resolved import resolved_yaml
from executive.tree.sources import shipped_names

PLUGINS = "plugins: {robot: mujoco, estimation: gnss_imu, mapping: voxel_map}\n"
MISSION = "trees: {main: {run: Scan}}\n"


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        path = folder / (name.replace("__", "/") + ".yaml")
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")


def errors(caught: pytest.ExceptionInfo[MissionFileError]) -> list[str]:
    return [problem.message for problem in caught.value.problems]


def test_a_mission_holds_checked_settings_with_si_units(load: Any) -> None:
    mission = load("trees:\n  main:\n    run: Scan\n    with: {angle: 180 deg, duration: 1 min}\n")
    settings = mission.trees["main"].root.kind.use.settings
    assert settings.angle == pytest.approx(3.14159, abs=1e-5)
    assert settings.duration == 60.0
    assert [one.name for one in mission.plugins["robot"]] == ["mujoco"]
    assert mission.loop.tick == 0.05


def test_plugins_come_in_the_order_of_the_data(load: Any) -> None:
    header = (
        "api: 1\nmission: test\nplugins:\n  mapping: voxel_map\n  monitoring: "
        "[payload_drop, jaw_slip]\n"
    )
    mission = load(MISSION, header=header + "  estimation: gnss_imu\n  robot: mujoco\n")
    assert list(mission.plugins) == ["robot", "estimation", "mapping", "monitoring"]
    assert [one.name for one in mission.plugins["monitoring"]] == ["payload_drop", "jaw_slip"]


def test_an_unknown_name_is_told_with_the_nearest_shipped_one(catalogue: Catalogue) -> None:
    with pytest.raises(MissionFileError, match="Did you mean 'pick_and_place'"):
        load_mission("pick_and_plaice", catalogue=catalogue)
    assert "pick_and_place" in shipped_names()


@pytest.mark.parametrize("name", ["", ".", "/", "..", "no/such.yaml", "a\0b", "x" * 5000, "~", "*"])
def test_a_name_that_is_no_mission_is_an_error(name: str, catalogue: Catalogue) -> None:
    with pytest.raises(MissionFileError):
        load_mission(name, catalogue=catalogue)


def test_a_base_is_laid_under_the_mission(tmp_path: Path, catalogue: Catalogue) -> None:
    base = "api: 1\nmission: base\nloop: {tick: 10 ms, runner: thread}\nplugins:\n"
    base += "  robot: {plugin: mujoco, model: mini, site: {stones: {count: 3}, size_m: [1, 2]}}\n"
    base += "  estimation: gnss_imu\n  mapping: {plugin: voxel_map, voxel_m: 0.2}\n"
    over = "api: 1\nmission: over\nextends: base\nloop: {tick: 20 ms}\n"
    over += "plugins: {robot: {site: {stones: {count: 4}}}}\n"
    write(tmp_path, base=base, over=over + MISSION)
    mission = load_mission(str(tmp_path / "over.yaml"), catalogue=catalogue)
    robot = mission.plugins["robot"][0].settings
    assert (robot.model, robot.site.stones.count, robot.site.size_m) == ("mini", 4, (1.0, 2.0))
    assert (mission.loop.tick, mission.loop.runner) == (0.02, "thread")
    assert mission.name == "over"


def test_another_plugin_takes_nothing_from_the_base(tmp_path: Path, catalogue: Catalogue) -> None:
    base = (
        "api: 1\nmission: "
        f"base\n{PLUGINS.replace('voxel_map', '{plugin: voxel_map, voxel_m: 0.2}')}"
    )
    over = (
        "api: 1\nmission: over\nextends: base.yaml\nplugins: {mapping: pose_graph, "
        "alignment: gicp}\n"
    )
    write(tmp_path, base=base, over=over + MISSION)
    mission = load_mission(str(tmp_path / "over.yaml"), catalogue=catalogue)
    assert mission.plugins["mapping"][0].name == "pose_graph"


def test_a_mistake_in_the_base_is_told_with_the_bases_name(
    tmp_path: Path, catalogue: Catalogue
) -> None:
    write(tmp_path, base="api: 1\nmission: base\nplugins: {robot: mujocco, estimation: gnss_imu, "
"mapping: "
"voxel_map}\n",
          over="api: 1\nmission: over\nextends: base\n" + MISSION)  # fmt: skip
    with pytest.raises(MissionFileError) as caught:
        load_mission(str(tmp_path / "over.yaml"), catalogue=catalogue)
    assert [str(p) for p in caught.value.problems] == [
        f"{tmp_path}/base.yaml:3:18: error: no robot plugin 'mujocco'. Did you mean 'mujoco'?",
        f"{tmp_path}/over.yaml: error: it uses what has mistakes: {tmp_path}/base.yaml",
    ]


@pytest.mark.parametrize("name", shipped_names())
def test_every_shipped_mission_can_be_extended_by_its_name(tmp_path: Path, name: str) -> None:
    over = f"api: 1\nmission: over\nextends: {name}\nloop: {{tick: 20 ms}}\n"
    write(tmp_path, over=over)
    mission = load_mission(str(tmp_path / "over.yaml"))
    assert mission.loop.tick == 0.02
    assert mission.trees.keys() == load_mission(name).trees.keys()


def test_files_that_extend_each_other_are_refused(tmp_path: Path, catalogue: Catalogue) -> None:
    write(
        tmp_path,
        a=f"api: 1\nmission: a\nextends: b\n{PLUGINS}{MISSION}",
        b="api: 1\nmission: b\nextends: a\n",
    )
    with pytest.raises(MissionFileError, match="in a circle"):
        load_mission(str(tmp_path / "a.yaml"), catalogue=catalogue)


def test_trees_of_the_base_can_be_called_and_replaced(tmp_path: Path, catalogue: Catalogue) -> None:
    base = (
        f"api: 1\nmission: base\n{PLUGINS}trees:\n  main: {{call: look}}\n  look: {{run: Scan}}\n"
    )
    over = "api: 1\nmission: over\nextends: base\ntrees:\n  look: {wait: 1 s}\n"
    write(tmp_path, base=base, over=over)
    mission = load_mission(str(tmp_path / "over.yaml"), catalogue=catalogue)
    assert mission.trees["look"].root.kind.label == "wait"


def test_a_mission_may_change_nothing_but_settings(tmp_path: Path, catalogue: Catalogue) -> None:
    over = "api: 1\nmission: over\nextends: base\nloop: {tick: 0.1}\n"
    write(tmp_path, base=f"api: 1\nmission: base\n{PLUGINS}{MISSION}", over=over)
    mission = load_mission(str(tmp_path / "over.yaml"), catalogue=catalogue)
    assert (list(mission.trees), mission.loop.tick) == (["main"], 0.1)


def test_subtrees_lie_in_a_folder_beside_the_mission(tmp_path: Path, catalogue: Catalogue) -> None:
    library = (
        "api: 1\ntrees:\n  look: {call: wink}\n  wink: {run: Scan}\n  unused: {run: Nonsense}\n"
    )
    write(
        tmp_path,
        m=f"api: 1\nmission: m\n{PLUGINS}trees: {{main: {{call: look}}}}\n",
        subtrees__library=library,
    )
    mission = load_mission(str(tmp_path / "m.yaml"), catalogue=catalogue)
    assert list(mission.trees) == ["main", "look", "wink"]


def test_a_tree_that_two_files_of_a_folder_define_is_refused(
    tmp_path: Path, catalogue: Catalogue
) -> None:
    tree = "api: 1\ntrees:\n  look: {run: Scan}\n"
    write(
        tmp_path,
        m=f"api: 1\nmission: m\n{PLUGINS}trees: {{main: {{call: look}}}}\n",
        subtrees__a=tree,
        subtrees__b=tree,
    )
    with pytest.raises(MissionFileError) as caught:
        load_mission(str(tmp_path / "m.yaml"), catalogue=catalogue)
    first, second = (tmp_path / "subtrees" / name for name in ("a.yaml", "b.yaml"))
    assert [str(problem) for problem in caught.value.problems] == [
        f"{tmp_path / 'm.yaml'}: error: it uses what has mistakes: {second}",
        f"{second}:3:3: error: tree 'look' is given twice; the first is at {first}:3:3",
    ]


@pytest.mark.parametrize(
    ("library", "told"),
    [
        ("api: 1\n", ":1:1: error: a file of subtrees needs 'trees'"),
        ("api: 2\ntrees: {look: {run: Scan}}\n", ":1:6: error: "),
        (
            "api: 1\ntree: {look: {run: Scan}}\n",
            "a file of subtrees has no 'tree'. Did you mean 'trees'?",
        ),
        ("api: 1\ntrees: [look]\n", ":2:8: error: 'trees' is "),
        ("- look\n", ":1:1: error: a file of subtrees is "),
    ],
)
def test_a_file_of_subtrees_that_is_none_is_told_at_its_place(
    tmp_path: Path, catalogue: Catalogue, library: str, told: str
) -> None:
    write(tmp_path, m=f"api: 1\nmission: m\n{PLUGINS}{MISSION}", subtrees__library=library)
    with pytest.raises(MissionFileError) as caught:
        load_mission(str(tmp_path / "m.yaml"), catalogue=catalogue)
    path = tmp_path / "subtrees" / "library.yaml"
    said = [str(one) for one in caught.value.problems if str(one).startswith(str(path))]
    assert any(told in one for one in said), said


def test_an_empty_list_takes_the_monitors_of_the_base_back(
    tmp_path: Path, catalogue: Catalogue
) -> None:
    base = f"api: 1\nmission: base\n{PLUGINS.replace('}', ', monitoring: [jaw_slip]}')}{MISSION}"
    write(
        tmp_path,
        base=base,
        over="api: 1\nmission: over\nextends: base\nplugins: {monitoring: []}\n",
    )
    assert "monitoring" in load_mission(str(tmp_path / "base.yaml"), catalogue=catalogue).plugins
    assert (
        "monitoring" not in load_mission(str(tmp_path / "over.yaml"), catalogue=catalogue).plugins
    )


def test_a_tree_that_nothing_calls_is_a_warning(load: Any) -> None:
    mission = load("trees:\n  main: {run: Scan}\n  other: {run: Scan}\n")
    assert [str(w).rpartition("mission.yaml")[2] for w in mission.warnings] == [
        ":6:3: warning: nothing calls tree 'other'"
    ]


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("robot.model=mini", "mini"),
        ("robot.site.stones.count=0x0F", 15),
        ("robot.site.size_m=[3, 4.5]", (3.0, 4.5)),
        ("robot.site={stones: {count: 2}}", 2),
        ("mapping.voxel_m=1e-1", 0.1),
        ("loop.tick=20 ms", 0.02),
        ("loop={runner: process}", "process"),
    ],
)
def test_an_option_is_the_last_layer(load: Any, option: str, value: object) -> None:
    mission = load(MISSION, option)
    robot, mapping = (mission.plugins[name][0].settings for name in ("robot", "mapping"))
    found = [
        robot.model,
        robot.site.stones.count,
        robot.site.size_m,
        mapping.voxel_m,
        *mission.loop.model_dump().values(),
    ]
    assert value in found


def test_options_can_change_and_add_plugins(load: Any) -> None:
    mission = load(MISSION, "mapping.plugin=pose_graph", "alignment=gicp", "monitoring=[jaw_slip, "
"payload_drop]",
                   "monitoring.jaw_slip.voxel_m=3")  # fmt: skip
    assert mission.plugins["mapping"][0].name == "pose_graph"
    assert mission.plugins["alignment"][0].name == "gicp"
    assert mission.plugins["monitoring"][0].settings.voxel_m == 3.0


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("robot.modell=mini", "mujoco has no setting 'modell'. Did you mean 'model'?"),
        (
            "robot.site.stones.count=many",
            "site.stones.count: input should be a valid integer, got 'many'",
        ),
        ("robot.site.stones.count=99", "input should be less than or equal to 50, got 99"),
        ("robto.model=mini", "no 'robto' to set. Did you mean 'robot'?"),
        ("robot.model=yes", "'yes' is true in YAML 1.1"),
        ("robot.model=[1", "a '[' is not closed"),
        ("robot.model", "expected capability.field=value"),
        ("=3", "expected capability.field=value"),
        ("robot..model=3", "expected capability.field=value"),
        ("loop=3", "expected loop.field=value"),
        ("loop.tick=0", "tick: input should be greater than or equal to 0.001, got 0"),
        ("viewing.path=x", "the mission selects no viewing plugin; set viewing.plugin first"),
        ("robot.plugin=repley", "no robot plugin 'repley'. Did you mean 'replay'?"),
    ],
)
def test_a_mistake_in_an_option_names_the_option(load: Any, option: str, words: str) -> None:
    with pytest.raises(MissionFileError) as caught:
        load(MISSION, option)
    assert [str(p).startswith(f"--set {option}: error: ") for p in caught.value.problems] == [True]
    assert words in errors(caught)[0]


EVERY_WORD = """
trees:
  main:
    timeout: 10 min
    sequence:
      - run: Scan
        with: {angle: 90 deg, label: "yes"}
        retry: {attempts: 3, pause: 1 s}
        on_failure: {wait: 1 s}
      - run: FindStones
      - for_each: {item: stone, in: "{stones}"}
        do:
          call: pick
          in: {tool: "1e3"}
          out: {held: "{held_now}"}
          if: {all: [Calm, {not: {any: ["{busy}", {check: HasStones}]}}]}
          while: Calm
      - parallel: [{wait: 2 s}, {check: Calm}]
        succeed: one
      - loop: {until: Calm, max: 3}
        do: {set: {a: 1, b: [x, "0b1"], c: "{stones}", d: true, e: null}}
      - optional: true
        name: question
        do: {ask: "Go on: now?", default: false}
      - reactive_fallback: [{check: Calm}, {fallback: [{reactive_sequence: [{check: Calm}]}]}]
  pick:
    in: {stone: Stone, tool: str?}
    out: {held: bool}
    run: Pick
"""


def test_a_mission_written_out_loads_again_as_the_same(
    load: Any, tmp_path: Path, catalogue: Catalogue
) -> None:
    mission = load(
        EVERY_WORD.replace(
            "      - run: FindStones", "      - set: {busy: false}\n      - run: FindStones"
        )
    )
    written = resolved_yaml(mission)
    path = tmp_path / "again.yaml"
    path.write_text(written, encoding="utf-8")
    again = load_mission(str(path), catalogue=catalogue)
    assert resolved_yaml(again) == written
    assert list(again.trees) == ["main", "pick"]
    assert again.plugins == mission.plugins
    assert "angle: 1.5707963267948966" in written
    assert 'label: "yes"' in written
    assert 'tool: "1e3"' in written


def test_actions_may_stand_anywhere_in_a_reactive_sequence(load: Any) -> None:
    mission = load("trees:\n  main:\n    reactive_sequence: [{run: Scan}, {check: Calm}]\n")
    assert len(mission.trees["main"].root.children()) == 2
