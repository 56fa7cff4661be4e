"""`faults:` and `watch:` are checked like the rest of a file, and kept when it is resolved."""

import pytest

from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.resolved import resolved_yaml
from tests.tree.conftest import DRY_MISSION


def load(tmp_path, text="", *overrides):
    path = tmp_path / "dry.yaml"
    path.write_text(DRY_MISSION + text, encoding="utf-8")
    return load_mission(str(path), overrides)


def mistakes(tmp_path, text):
    with pytest.raises(MissionFileError) as error:
        load(tmp_path, text)
    return str(error.value)


WRONG = {
    "- {sensor: imu_cabn, how: silent, at: 1}": "no sensor 'imu_cabn'. Did you mean 'imu_cabin'?",
    "- {sensor: imu, how: silnt, at: 1}": "how: input should be 'silent'",
    "- {sensor: imu, how: silent}": "one of at, node and chance; got none of them",
    "- {sensor: imu, how: silent, at: 1, chance: 0.1}": "got at and chance",
    "- {sensor: imu, how: silent, at: -1}": "at: input should be greater than or equal to 0",
    "- {sensor: imu, how: silent, node: Locallise}": "no node is called 'Locallise'. Did you mean",
    "- {sensor: imu, how: float, at: 1}": "is a fault of satellite receivers",
    "- {sensor: imu, how: silent, at: 1, delay: 1 s}": "a fault `silent` has no delay",
    "- {sensor: imu, how: silent, at: 1, untl: 3}": "has no setting 'untl'",
    "- {actuator: J_BOM, how: sluggish, at: 1}": "no actuator 'J_BOM'. Did you mean 'J_BOOM'?",
    "- {actuator: arm, how: open, at: 1}": "only the jaws can open",
    "- {plugin: motion, verb: swing, how: raise, at: 1}": "the mission selects no motion plugin",
    "- {plugin: estimation, verb: ad_imu, how: hang, at: 1}": "no verb 'ad_imu'",
    "- {how: silent, at: 1}": "a fault is of one of sensor, actuator, plugin; got none",
}


@pytest.mark.parametrize("fault", WRONG)
def test_a_wrong_fault_is_told_at_its_place_with_the_cure(tmp_path, fault):
    told = mistakes(tmp_path, f"faults:\n  {fault}\n")
    assert WRONG[fault].lower() in told.lower()
    assert "dry.yaml:11:" in told


def test_an_empty_section_has_no_faults_and_a_word_is_none(tmp_path):
    assert load(tmp_path, "faults:\n").faults == ()
    assert "dry.yaml:10:9: error: 'faults'" in mistakes(tmp_path, "faults: twice\n")


def test_a_wrong_rule_is_told_at_its_place_with_the_cure(tmp_path):
    told = mistakes(
        tmp_path, "watch:\n  encodrs: stop\n  imu: {do: hld}\n  gnss: {do: stop, wait: 3 s}\n"
    )
    assert (
        "dry.yaml:11:3: error: 'watch' has no condition 'encodrs'. Did you mean 'encoders'?" in told
    )
    assert "dry.yaml:12:13" in told
    assert "wait belongs to `do: hold` and `do: fail`, not to `stop`" in told


def test_faults_and_rules_last_through_the_resolved_file(tmp_path):
    text = (
        "watch:\n  encoders: stop\n  estimate: {do: hold, wait: 2 min, status: [GLOBAL]}\n"
        "faults:\n  - {sensor: gnss, how: delayed, delay: 300 ms, node: Localise, lasts: 2 s}\n"
        "  - {actuator: jaws, how: open, at: 5 s}\n"
        "  - {plugin: estimation, verb: add_imu, how: raise, chance: 0.01}\n"
    )
    mission = load(tmp_path, text)
    path = tmp_path / "again.yaml"
    path.write_text(resolved_yaml(mission), encoding="utf-8")
    again = load_mission(str(path))
    assert (again.faults, again.watch) == (mission.faults, mission.watch)
    assert [fault.target for fault in again.faults] == ["gnss", "jaws", "estimation.add_imu"]


def test_options_set_faults_and_rules(tmp_path):
    mission = load(
        tmp_path,
        "watch: {imu: stop}\n",
        "faults=[{sensor: imu, how: stuck, at: 3 s}]",
        "watch.imu=tell",
        "watch.gnss={do: stop}",
    )
    assert mission.faults[0].how == "stuck"
    assert (mission.watch["imu"].do, mission.watch["gnss"].do) == ("tell", "stop")


@pytest.mark.parametrize("name", ["pick_and_place", "relocate", "map_site"])
def test_the_shipped_missions_have_rules(name):
    mission = load_mission(name)
    assert mission.watch["encoders"].do == "stop"
    assert mission.watch["imu"].do == mission.watch["estimate"].do == "hold"
    assert not mission.faults
