"""Every mistake in one pass, and the cause without what follows from it, with what is installed."""

from pathlib import Path

import pytest

from executive.machine.machine import machine_file
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.sources import shipped_folder

ROBOT_YAML = machine_file("m545")


def told(path: Path, text: str, *settings: str) -> list[str]:
    """Return what is said of a mission, without its folder."""
    path.write_text(text, encoding="utf-8")
    try:
        load_mission(str(path), settings, is_for_here=True)
    except MissionFileError as error:
        return [str(one).replace(f"{path.parent}/", "") for one in error.problems]
    return []


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "mine.yaml"


def test_a_base_that_is_not_found_is_one_mistake(path: Path) -> None:
    text = (shipped_folder() / "pick_and_place.yaml").read_text()
    assert told(path, text.replace("extends: base", "extends: bse")) == [
        "mine.yaml:4:10: error: no file 'bse' to extend. Did you mean 'base'?"
    ]


def test_unwritten_keys_are_told_with_the_rest(path: Path) -> None:
    text = (
        "api: 1\nmission: m\nextends: base\ntrees:\n  main:\n    sequence:\n"
        '      - run: Localse\n      - wait: 5 kg\n      - check: "{nokey} > 3"\n'
    )
    lines = [one.split(": ")[0] for one in told(path, text)]
    assert lines == ["mine.yaml:7:14", "mine.yaml:8:15", "mine.yaml:9:18"]


def test_what_a_plugin_needs_of_the_robot_is_checked(path: Path) -> None:
    text = (shipped_folder() / "pick_and_place.yaml").read_text()
    only, mission = sorted(told(path, text, "robot.plugin=kinematic"), key=len, reverse=True)
    assert "mine.yaml: error: it uses what has mistakes" in mission
    assert "base.yaml:9:3: error: the surveying plugin 'simulated_drone' needs" in only
    assert "'scene', and 'kinematic' has none; choose robot: mujoco" in only


def test_what_only_this_machine_refuses_is_told_at_its_setting(path: Path) -> None:
    text = (
        "api: 1\nmission: m\nextends: base\nplugins:\n  estimation: {imu: imu_cabn}\n"
        "  robot: {sensors: {dropouts: [{sensor: lidar_x, from_s: 1, to_s: 2}]}}\n"
        "  surveying: {plugin: point_cloud_file, path: /none/map.ply}\n"
        "trees:\n  main: {run: Localise}\n"
    )
    places = [one.split(": ")[0] for one in told(path, text)]
    assert places == ["mine.yaml:5:21", "mine.yaml:6:41", "mine.yaml:7:47"]


def test_the_machines_file_is_checked_at_its_lines(path: Path, tmp_path: Path) -> None:
    lines = ROBOT_YAML.read_text().splitlines()
    line = next(i for i, one in enumerate(lines) if "palm_mass_kg" in one)
    lines[line] = lines[line].replace("palm_mass_kg", "palm_mas_kg")
    (tmp_path / "odd").mkdir()
    (tmp_path / "odd" / "robot.yaml").write_text("\n".join(lines))
    text = "api: 1\nmission: m\nextends: base\ntrees:\n  main: {run: Localise}\n"
    found = told(path, text, f"robot.model={tmp_path / 'odd'}")
    assert len(found) == 3  # the mission, too, is named
    assert any(one.startswith(f"odd/robot.yaml:{line + 1}:3: error: gripper.palm") for one in found)
    (unknown,) = told(path, text, "robot.model=m54")
    assert "--set robot.model=m54: error: no machine 'm54'" in unknown
    assert "Did you mean 'm545'?" in unknown
