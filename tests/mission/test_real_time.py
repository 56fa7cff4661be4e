"""On the wall clock no verb delays the tick, a timeout ends it, and a stop outranks a success."""

import functools
import threading
import time

import pytest
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.robot.kinematic import KinematicRobot

from executive.commands.main import main
from executive.events.mission import TickLate
from executive.journal import Journal, read_journal
from executive.mission.context import NodeContext
from executive.mission.options import Options
from executive.mission.record.keeper import Keeper
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
LATE_S = 0.3  # longer than a busy computer makes most ticks late
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
    assert "for progress" in report.reason
    assert report.late_ticks.causes["progress"] >= 3


def test_a_late_tick_names_what_took_the_time(tmp_path, monkeypatch):
    verbs = {
        "leaf in main/1:ScanSwing": (NodeContext, "arm"),
        "robot.read": (KinematicRobot, "read"),
        "estimation.add_joints": (GnssImuFilter, "add_joints"),
        "keeping": (Keeper, "keep"),
        "journal": (Journal, "append"),
    }
    # One after another, ticks apart: the leaf asks where the arm is when it begins.
    waiting = list(verbs)
    armed = [waiting.pop(0)]

    def delayed(cause, verb):
        @functools.wraps(verb)
        def slow(self, *args, **kwargs):
            if cause in armed:
                armed.remove(cause)
                time.sleep(LATE_S)
            return verb(self, *args, **kwargs)

        return slow

    for cause, (owner, name) in verbs.items():
        monkeypatch.setattr(owner, name, delayed(cause, getattr(owner, name)))

    def arm(mission):
        if waiting and not armed and mission.tick % 5 == 0:
            armed.append(waiting.pop(0))

    swing = "{run: ScanSwing, with: {angle: 20 deg, duration: 2 s}}"
    text = f"loop: {{late_ticks: 1000}}\ntrees: {{main: {{sequence: [wait: 0.3 s, {swing}]}}}}"
    report = run(tmp_path, text, arm, runner="thread")
    assert report.outcome == "success"
    events = [entry.event for entry in read_journal(tmp_path / "run" / "journal.jsonl")]
    told = {one.cause for one in events if isinstance(one, TickLate) and one.took_s >= LATE_S}
    assert not {cause for cause in verbs if not any(one.startswith(cause) for one in told)}
    assert set(report.late_ticks.causes) >= told


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
