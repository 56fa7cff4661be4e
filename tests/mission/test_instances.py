"""Several plugins of one capability in one mission, through the front door."""

import json
import sys

import pytest
from executive_plugins.motion.hermite import Hermite
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.commands.main import main
from executive.journal import read_journal
from executive.mission.assembly import assemble
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.selection import Selection

MISSION = """
api: 1
mission: turning
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  objects: sqlite
  motion:
    brisk: {plugin: hermite}
    slow: {plugin: hermite, speed: 0.3}
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: TurnCabin
        with: {heading: 60 deg}
        use: brisk
      - call: back
        use: slow
  back:
    sequence:
      - run: TurnCabin
        with: {heading: 0}
"""


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    def run_text(*words, mission=MISSION, name="run"):
        (tmp_path / "turning.yaml").write_text(mission, encoding="utf-8")
        monkeypatch.chdir(tmp_path)
        command = ["executive", "run", "turning.yaml", f"--run-dir={name}", "--quiet", *words]
        monkeypatch.setattr(sys, "argv", command)
        with pytest.raises(SystemExit) as end:
            main()
        folder = tmp_path / name
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
        entries = list(read_journal(folder / "journal.jsonl"))
        return int(end.value.code or 0), capsys.readouterr().err, report, entries

    return run_text


def duration_s(entries, node):
    times = [entry.time_s for entry in entries if entry.node.endswith(node)]
    return times[-1] - times[0]


def test_each_leaf_moves_by_the_plugin_that_it_or_its_call_chooses(run):
    status, said, report, entries = run()
    assert status == 0, said
    there, back = duration_s(entries, "/1:TurnCabin"), duration_s(entries, "/0:TurnCabin")
    assert back > 1.5 * there  # 0.3 instead of 0.9 of velocity and acceleration, the same jerk
    assert report["plugins"]["motion.brisk"] == report["plugins"]["motion.slow"] == ["hermite"]


def test_a_setting_of_one_of_them_leaves_the_other_as_it_is(run):
    _, _, _, entries = run("--set", "motion.brisk.speed=0.3")
    there, back = duration_s(entries, "/1:TurnCabin"), duration_s(entries, "/0:TurnCabin")
    assert there == pytest.approx(back, abs=0.3)


def test_worker_processes_give_the_same_journal(run, tmp_path):
    run(name="inline")
    run("--runner", "process", name="process")
    inline, process = ((tmp_path / n / "journal.jsonl").read_bytes() for n in ("inline", "process"))
    assert inline == process


def test_an_error_names_the_plugin_and_its_name_in_the_mission(run, monkeypatch):
    broken = Hermite.move_joints

    def move_joints(self, request):
        if self._settings.speed < 0.5:
            raise ValueError("no such speed")
        return broken(self, request)

    monkeypatch.setattr(Hermite, "move_joints", move_joints)
    status, said, report, _ = run()
    assert status == 3
    assert "motion.slow plugin 'hermite' failed in 'move_joints': ValueError" in said
    assert report["fault"]["capability"] == "motion.slow"


def test_one_that_the_mission_can_do_without_fails_its_leaf_alone(run, monkeypatch):
    def move_joints(self, request):
        raise ValueError("no such speed")

    monkeypatch.setattr(Hermite, "move_joints", move_joints)
    weak = MISSION.replace("slow: {plugin: hermite,", "slow: {plugin: hermite, on_error: fail,")
    status, said, _, _ = run(mission=weak.replace("use: brisk", "use: slow"))
    assert status == 1, said
    status, said, _, _ = run(mission=weak, name="other")
    assert status == 3, said


def test_a_plugin_is_given_the_one_that_it_names(run, tmp_path):
    more = MISSION.replace(
        "trees:", "  grasping: {plugin: sampled_antipodal, use: slow}\n  placing: slots\ntrees:", 1
    )
    (tmp_path / "more.yaml").write_text(more, encoding="utf-8")
    with pytest.raises(MissionFileError, match="'slots' is given a motion plugin") as refused:
        load_mission(str(tmp_path / "more.yaml"))
    assert "choose one with 'use: brisk' beside 'plugin: slots'" in str(refused.value)
    (tmp_path / "more.yaml").write_text(more.replace("  placing: slots\n", ""), encoding="utf-8")
    mission = load_mission(str(tmp_path / "more.yaml"))
    made = assemble(mission.plugins, "m545", 1).plugins
    assert made["grasping"]._arm._motion is made["motion.slow"]


@pytest.mark.parametrize(
    ("chosen", "may_tip"),
    [
        ({}, True),
        ({"scenario": "harsh"}, True),
        ({"scenario": "kind"}, False),
        ({"base": "welded"}, False),
        ({"scenario": "kind", "base": "on_legs"}, True),
    ],
)
def test_a_machine_on_legs_may_tip_which_limits_its_lifts(chosen, may_tip):
    mujoco = Selection("mujoco", MujocoSettings(**chosen))
    machine = assemble({"robot": (mujoco,)}, "m545", 1).machine
    assert machine.stance.limits_by_tipping("by_base") == may_tip
    assert not machine.stance.limits_by_tipping("payload")
