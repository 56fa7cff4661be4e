"""On the wall clock no verb delays the tick, a timeout ends it, and a stop outranks a success."""

import threading
import time

import pytest

from executive.commands.main import main
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

HEAD = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
"""
SWING = """
trees:
  main:
    sequence:
      - wait: 0.2 s
      - timeout: 1 s
        do: {run: ScanSwing, with: {angle: 20 deg, duration: 5 s}}
"""
ENDLESS_S = 120.0  # of a verb: longer than a busy computer takes to end the mission


def run(tmp_path, text, after_tick=lambda mission: None, **options):
    path = tmp_path / "dry.yaml"
    path.write_text(HEAD + text)
    made = Run(
        load_mission(str(path)), Options(run_dir=tmp_path / "run", real_time=True, **options)
    )
    return made.execute(after_tick).report


def test_a_timeout_ends_a_verb_that_runs(tmp_path, monkeypatch):
    over, ended = threading.Event(), threading.Event()

    def swing(self, start, angle_rad, duration_s, around=None):
        over.wait(ENDLESS_S)
        ended.set()
        raise RuntimeError("nobody waits for this")

    monkeypatch.setattr("executive_plugins.motion.hermite.Hermite.swing", swing)
    report = run(tmp_path, SWING, runner="thread")
    has_waited = ended.is_set()
    over.set()
    assert report.outcome == "failure"
    assert "not done within 1 s" in report.reason
    assert not has_waited


def test_a_stop_in_the_tick_in_which_the_tree_succeeds_is_no_success(tmp_path):
    def stop(mission):
        mission.request_stop()

    report = run(tmp_path, "trees: {main: {wait: 0.01 s}}", stop, runner="thread")
    assert report.outcome == "stopped"


def test_too_many_late_ticks_bring_the_safe_stop(tmp_path):
    def dawdle(mission):
        time.sleep(0.08)

    text = "loop: {late_ticks: 3}\ntrees: {main: {wait: 30 s}}"
    report = run(tmp_path, text, dawdle, runner="thread")
    assert report.outcome == "fault"
    assert "3 ticks in a row took longer than their 0.05 s" in report.reason
    assert report.late_ticks.count >= 3


def test_verbs_in_the_tick_of_the_wall_clock_are_refused(tmp_path, monkeypatch, capsys):
    (tmp_path / "dry.yaml").write_text(HEAD + SWING)
    monkeypatch.setattr(
        "sys.argv",
        ["executive", "run", str(tmp_path / "dry.yaml"), "--real-time", "--runner", "inline"],
    )
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    assert "no verb is computed in the tick" in capsys.readouterr().err
