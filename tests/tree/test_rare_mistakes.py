"""Mistakes of missions that are seldom made: each is told once, at its place, with its cure."""

from pathlib import Path
from typing import Any

import pytest

from executive.tree.document import read_text
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError, Problems
from tests.tree.conftest import DRY_MISSION


def told(load: Any, text: str, *overrides: str) -> list[str]:
    """Return the mistakes of a mission, without the folder of its file."""
    with pytest.raises(MissionFileError) as caught:
        load(text, *overrides)
    return [str(one).rpartition("/")[2] for one in caught.value.problems]


@pytest.mark.parametrize(
    ("main", "problem"),
    [
        (
            '{switch: "{k}", cases: {}}',
            "mission.yaml:5:32: error: 'cases' needs at least one 'value: node'",
        ),
        ('{switch: "{k}", cases: 3}', "mission.yaml:5:32: error: 'cases' is a mapping, not 3"),
        (
            '{switch: "{k}"}',
            "mission.yaml:5:10: error: 'switch' needs 'cases:' with a node for each value",
        ),
    ],
)
def test_a_switch_without_cases(load: Any, main: str, problem: str) -> None:
    text = f"trees:\n  main: {main}\n"
    assert problem in told(load, text)


def test_a_case_that_is_skipped_leaves_its_switch_skipped(play: Any) -> None:
    main = 'switch: "{k}"\ncases: {left: {check: Calm}}\nelse: skip'
    assert play(f"sequence:\n  - set: {{k: left}}\n  - {indented(main)}").finish() == "SUCCESS"
    skipped = play(f"sequence:\n  - set: {{k: right}}\n  - {indented(main)}")
    assert skipped.finish() == "SUCCESS"
    assert not [node for node, _ in skipped.runtime.endings() if "Calm" in node]


def indented(text: str) -> str:
    return text.replace("\n", "\n    ")


@pytest.fixture
def dry(tmp_path: Path) -> Any:
    """Load a mission of the installed plugins."""

    def load(text: str, *overrides: str) -> Any:
        path = tmp_path / "dry.yaml"
        path.write_text(DRY_MISSION + text, encoding="utf-8")
        return load_mission(str(path), overrides)

    return load


@pytest.mark.parametrize(
    ("text", "overrides", "problem"),
    [
        (
            "",
            ("faults.imu=silent",),
            "--set faults.imu=silent: error: faults are set as a whole: "
            "faults=[{sensor: gnss, how: silent, at: 30 s}]",
        ),
        ("faults:\n  - silent\n", (), "dry.yaml:11:5: error: a fault is a mapping, not 'silent'"),
        ("watch: [imu]\n", (), "dry.yaml:10:8: error: 'watch' is a mapping, not a list"),
        ("watch:\n  imu: [stop]\n", (), "dry.yaml:11:8: error: the rule of 'imu' is a mapping, "),
        (
            "faults:\n  - {sensor: imu, actuator: arm, how: silent, at: 1}\n",
            (),
            "dry.yaml:11:5: error: a fault is of one of sensor, actuator, plugin; "
            "got sensor and actuator",
        ),
    ],
)
def test_faults_and_rules_of_another_form(
    dry: Any, text: str, overrides: tuple[str, ...], problem: str
) -> None:
    assert any(problem in one for one in told(dry, text, *overrides))


def test_a_rule_of_an_option_takes_the_place_of_a_list(dry: Any) -> None:
    assert dry("watch: {imu: stop}\n", "watch.gnss=tell").watch.keys() == {"imu", "gnss"}


def test_several_plugins_are_set_by_the_name_of_one_and_a_field(load: Any) -> None:
    header = (
        "api: 1\nmission: test\nplugins:\n  robot: mujoco\n  estimation: gnss_imu\n"
        "  mapping: voxel_map\n  monitoring: [{plugin: jaw_slip, voxel_m: 0.1}, payload_drop]\n"
    )
    trees = "trees:\n  main: {check: Calm}\n"

    def given(text: str, *overrides: str) -> Any:
        return load(text, *overrides, header=header)

    for option in ("monitoring.jaw_slp.voxel_m=0.2", "monitoring.jaw_slip=3"):
        (problem,) = told(given, trees, option)
        words = "several plugins are selected: name one of them and a field"
        assert problem.startswith(f"--set {option}: error: {words}")
    assert "Did you mean 'jaw_slip'?" in told(given, trees, "monitoring.jaw_slp.voxel_m=0.2")[0]
    found = given(trees, "monitoring.jaw_slip.voxel_m=0.2").plugins["monitoring"]
    assert [one.name for one in found] == ["jaw_slip", "payload_drop"]
    assert found[0].settings.voxel_m == 0.2


def test_a_tree_of_an_option_takes_the_place_of_one_that_the_mission_has(load: Any) -> None:
    trees = "trees:\n  main: {call: other}\n  other: {check: Calm}\n"
    mission = load(trees, "trees.other={wait: 3 s}")
    assert type(mission.trees["other"].root.kind).__name__ == "Wait"
    (problem,) = told(load, trees, "trees.othr={wait: 3 s}")
    assert "the mission has no tree 'othr' of its own to replace. Did you mean 'other'?" in problem


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "f:1:1: error: the file is empty; a mission begins with 'api: 1'"),
        ("[" * 61, "f:1:61: error: nested more than 60 levels deep"),
        ("a: 1\n--- \nb: 2\n", "f:2:1: error: a second document begins here; a file holds one"),
        ("a: \x07\n", "f:1:4: error: a control character (U+0007) does not belong into a mission"),
    ],
)
def test_a_document_that_is_none(text: str, problem: str) -> None:
    problems = Problems()
    read_text(text, "f", problems)
    assert str(problems.all()[0]).startswith(problem)


def test_sixty_levels_are_read() -> None:
    problems = Problems()
    assert read_text("[" * 60 + "]" * 60, "f", problems) is not None
    assert problems.all() == ()
