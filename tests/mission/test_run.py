"""A run ends in the right way whatever happens, and its folder tells all of it."""

import json
import os
import resource
import signal
import subprocess
import sys
import time

import pytest
from executive_plugins.robot.kinematic import KinematicRobot

from executive.errors import ConfigError
from executive.events.mission import PhaseChanged
from executive.journal import read_journal
from executive.mission.options import Options
from executive.mission.report import cpu_s
from executive.mission.run import Run
from executive.mission.stop_signals import Aborted
from executive.tree.load import load_mission

PLUGINS = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
  objects: sqlite
"""
SWING = """
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 60 deg, duration: 8 s}
"""


def run(tmp_path, text, *, name="run", overrides=(), after_tick=lambda mission: None, **options):
    path = tmp_path / "dry.yaml"
    path.write_text(PLUGINS + text)
    made = Run(load_mission(str(path), overrides), Options(run_dir=tmp_path / name, **options))
    return made.execute(after_tick)


def kinds(result):
    return [entry.kind for entry in read_journal(result.folder.journal)]


def test_a_mission_runs_to_its_end(tmp_path):
    result = run(tmp_path, SWING)
    assert (result.report.outcome, result.exit_status) == ("success", 0)
    assert result.report.counts.scans == 1
    for path in (
        result.folder.mission,
        result.folder.journal,
        result.folder.objects,
        result.folder.map,
        result.folder.log,
    ):
        assert path.exists(), path
    assert json.loads(result.folder.report.read_text()) == result.report.payload()


def test_what_a_mission_tells_is_in_its_report_and_its_summary(tmp_path):
    told = """
trees:
  main:
    sequence:
      - check: ReportFigure
        with: {name: depth, value: 1.5, unit: m}
      - check: MarkPoint
        with: {text: here, at: [1 m, 2 m, 0 m]}
      - check: CountStones
      - optional: true
        do: {check: ListStones}
"""
    result = run(tmp_path, told)
    report = result.report.payload()
    assert report["figures"] == {"depth": {"value": 1.5, "unit": "m"}}
    assert [(one["text"], one["position_map"]) for one in report["marks"]] == [("here", [1, 2, 0])]
    assert (report["stones"], report["maps"]) == ([], [])
    assert report["plugins"]["motion"] == ["hermite"]
    assert "figure     depth = 1.5 m" in result.summary


def test_the_report_says_what_the_run_took(tmp_path):
    begun_s = cpu_s()
    taken = run(tmp_path, SWING).report.resources
    assert 0 < taken.cpu_s <= cpu_s() - begun_s + 1e-3  # of this run, not of the whole process
    own = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # kibibytes on Linux
    assert 0.0 <= taken.compiling_s <= taken.cpu_s
    assert taken.peak_memory_bytes >= 0.5 * own  # it may have grown a little since


def test_the_resolved_mission_runs_again_to_the_same_journal(tmp_path):
    first = run(tmp_path, SWING)
    again = Run(
        load_mission(str(first.folder.mission)), Options(run_dir=tmp_path / "again")
    ).execute(lambda mission: None)
    assert again.folder.journal.read_bytes() == first.folder.journal.read_bytes()


def test_every_runner_writes_the_same_journal(tmp_path):
    journals = {
        runner: run(tmp_path, SWING, name=runner, runner=runner).folder.journal.read_bytes()
        for runner in ("inline", "thread", "process")
    }
    assert len(set(journals.values())) == 1


def test_two_missions_in_one_process_do_not_see_each_other(tmp_path):
    path = tmp_path / "dry.yaml"
    path.write_text(PLUGINS + SWING)
    alone = run(tmp_path, SWING, name="alone")
    first, second = (
        Run(load_mission(str(path)), Options(run_dir=tmp_path / name)) for name in ("a", "b")
    )
    inner = []

    def start_the_other(mission):
        if not inner and mission.clock.now_s() > 4.0:
            inner.append(second.execute(lambda mission: None))

    outer = first.execute(start_the_other)
    expected = alone.folder.journal.read_bytes()
    assert outer.folder.journal.read_bytes() == expected
    assert inner[0].folder.journal.read_bytes() == expected


def test_a_failing_tree_is_a_failed_mission_with_the_reason(tmp_path):
    result = run(tmp_path, "trees: {main: {sequence: [{check: SelectLargest}]}}")
    assert (result.report.outcome, result.exit_status) == ("failure", 1)
    assert "no stone is left" in result.report.reason


def test_the_time_limit_ends_a_mission(tmp_path):
    result = run(tmp_path, "trees: {main: {wait: 10 min}}", overrides=["loop.time_limit=3"])
    assert (result.report.outcome, result.exit_status) == ("failure", 1)
    assert "time limit of 3 s" in result.report.reason


def test_a_robot_that_fails_is_a_fault_and_the_report_is_whole(tmp_path):
    result = run(tmp_path, SWING, overrides=["robot.fails_at_s=6"])
    assert (result.report.outcome, result.exit_status) == ("fault", 3)
    assert "has not answered since 6.00 s" in result.report.reason
    assert kinds(result)[-1] == "mission_ended"


def test_a_stop_brings_the_machine_to_rest_along_its_path(tmp_path):
    speeds = []

    def stop_in_mid_swing(mission):
        if mission.clock.now_s() > 6.0:
            mission.request_stop()
        speeds.append(
            abs(mission.services.joints().velocity).max() if mission.clock.now_s() > 1 else 0.0
        )

    result = run(tmp_path, SWING, after_tick=stop_in_mid_swing)
    assert (result.report.outcome, result.exit_status) == ("stopped", 1)
    assert max(speeds) > 0.05
    assert speeds[-1] < 0.01
    events = [entry.event for entry in read_journal(result.folder.journal)]
    phases = [event.after for event in events if isinstance(event, PhaseChanged)]
    assert phases == ["running", "stopping", "done"]


def test_questions_are_answered_by_the_option_and_the_journal_says_so(tmp_path):
    ask = "trees: {main: {ask: 'Is the site clear?'}}"
    yes = run(tmp_path, ask, name="yes", answer=True)
    no = run(tmp_path, ask, name="no", answer=False)
    assert (yes.exit_status, no.exit_status) == (0, 1)
    assert '"option"' in yes.folder.journal.read_text()


@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_in_mid_swing_ends_with_a_whole_report(tmp_path, times):
    """Once: along the path, then the report; twice: at once, and still the report."""
    (tmp_path / "dry.yaml").write_text(PLUGINS + SWING.replace("8 s", "60 s"))
    words = ["run", "dry.yaml", "--run-dir", "run", "--real-time"]
    code = (
        f"import sys; sys.argv = ['executive', *{words!r}]; from executive.commands.main "
        "import main; main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    journal = tmp_path / "run" / "journal.jsonl"
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not (
        journal.exists() and "ScanSwing" in journal.read_text()
    ):
        time.sleep(0.1)
    time.sleep(1.5)
    for _ in range(times):
        os.kill(process.pid, signal.SIGINT)
        time.sleep(0.02)
    _, said = process.communicate(timeout=60)
    report = json.loads((tmp_path / "run" / "report.json").read_text())
    assert process.returncode == 1
    assert report["outcome"] == "stopped"
    assert "Traceback" not in said
    assert list(read_journal(journal))


def test_ended_at_once_no_leaf_outlives_the_robot(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(KinematicRobot, "stop", lambda robot: calls.append("stop"))
    monkeypatch.setattr(KinematicRobot, "close", lambda robot: calls.append("close"))

    def ask_twice(mission):
        if mission.clock.now_s() > 6.0:
            raise Aborted("stopped at once by the operator")

    result = run(tmp_path, SWING, after_tick=ask_twice)
    assert (result.report.outcome, result.report.reason) == (
        "stopped",
        "stopped at once by the operator",
    )
    swing = [e for e in read_journal(result.folder.journal) if e.node == "main/1:ScanSwing"]
    assert [e.kind for e in swing] == ["node_started", "leaf_called", "node_ended"]
    assert calls == ["stop", "close"]  # the leaf's clean-up stops the machine while there is one


@pytest.mark.parametrize("capability", ["robot", "mapping", "objects"])
def test_a_run_that_is_stopped_while_a_plugin_starts_is_stopped(tmp_path, monkeypatch, capability):
    """Whichever plugin the signal meets: what has not started yet is asked for nothing."""
    path = tmp_path / "dry.yaml"
    path.write_text(PLUGINS + SWING)
    made = Run(load_mission(str(path)), Options(run_dir=tmp_path / "run"))
    plugin = made._assembly.plugins[capability]

    def start(*_words, **_options):
        raise Aborted("stopped while it was starting")

    monkeypatch.setattr(plugin, "start", start)
    result = made.execute(lambda mission: None)
    assert (result.report.outcome, result.exit_status) == ("stopped", 1)
    assert kinds(result) == ["mission_ended"]
    assert not result.folder.map.exists()


def test_a_recording_without_a_viewer_is_refused_before_anything_is_made(tmp_path):
    cure = "--record: the mission selects no viewer; add --set viewing.plugin=rerun"
    with pytest.raises(ConfigError, match=cure):
        run(tmp_path, SWING, record=True)
    assert not list(tmp_path.glob("**/journal.jsonl"))


def test_a_viewer_that_fails_does_not_disturb_the_mission(tmp_path, monkeypatch):
    def show(self, stamp_s, entity, value):
        raise RuntimeError("out of ink")

    monkeypatch.setattr("executive_plugins.viewing.none.NoViewer.show", show)
    result = run(tmp_path, SWING, overrides=["viewing.plugin=none"], record=True)
    assert result.report.outcome == "success"
    assert result.folder.log.read_text().count("viewing plugin 'none' failed in 'show'") == 1
    assert result.report.counts.plugin_failures == 1
