"""A run that is cut off in its own process ends with status 3, and says what it computed then."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import pytest

MISSION = """
api: 1
mission: dry
plugins:
  robot: {{plugin: kinematic, model: m545}}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: {{plugin: faulty, fault: {fault}}}
loop: {{jobs: {{least_limit: 1 s, memory: 400 MB}}}}
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {{angle: 30 deg, duration: 2 s}}
"""
WAITS = """
api: 1
mission: dry
plugins: {robot: {plugin: kinematic, model: m545}, estimation: gnss_imu_filter}
trees:
  main:
    sequence:
      - {run: Localise, timeout: 30 s}
      - wait: 3 s
"""
EXECUTIVE = [sys.executable, "-m", "executive.commands.entry"]


@pytest.fixture
def environment(faulty_folder):
    path = os.pathsep.join([str(faulty_folder), os.environ.get("PYTHONPATH", "")])
    return {**os.environ, "PYTHONPATH": path}


def run_of(folder, environment, text, *words):
    (folder / "dry.yaml").write_text(text, encoding="utf-8")
    return subprocess.run(
        [*EXECUTIVE, "run", "dry.yaml", "--run-dir=run", "--quiet", *words],
        cwd=folder, env=environment, capture_output=True, text=True, timeout=120,
    )  # fmt: skip


def wait_until(is_so):
    limit_s = time.monotonic() + 240
    while not is_so():
        assert time.monotonic() < limit_s
        time.sleep(0.05)


@pytest.fixture
def run(tmp_path, environment):
    def run_with(fault, *words):
        ended = run_of(tmp_path, environment, MISSION.format(fault=fault), *words)
        report = tmp_path / "run" / "report.json"
        found = json.loads(report.read_text(encoding="utf-8")) if report.exists() else {}
        return ended.returncode, ended.stderr, found

    return run_with


@pytest.mark.parametrize(
    ("fault", "runner", "how"),
    [
        ("segfault", "inline", "SIGSEGV"),
        ("sigkill", "thread", "SIGKILL"),
        ("os_exit", "inline", "exit status 0 before its run was over"),
        ("hold_gil", "thread", "did not end in time"),
    ],
)
def test_a_plugin_that_ends_or_blocks_the_executive_is_named(run, fault, runner, how):
    status, said, report = run(fault, f"--runner={runner}")
    assert status == 3, said
    assert report["outcome"] == "fault"
    assert "motion plugin 'faulty' failed in 'swing'" in report["reason"]
    assert how in report["reason"]
    assert re.search(r"faulty_plugins\.py:\d+", report["reason"])
    assert report["reason"] in said
    assert report["fault"]["verb"] == "swing"


@pytest.mark.parametrize("fault", ["hang", "sys_exit", "start"])
def test_a_plugin_that_fails_in_the_executive_ends_in_a_report_of_its_own(run, fault):
    status, said, report = run(fault)
    assert status == 3, said
    assert "motion plugin 'faulty'" in report["reason"]
    assert re.search(r"faulty_plugins\.py:\d+", report["reason"])
    assert "Traceback" not in said


def test_in_real_time_a_silent_loop_is_noticed(run):
    status, said, _ = run("hold_gil", "--real-time", "--runner=thread")
    assert status == 3, said
    assert re.search(r"supervisor: the (executive's loop has been silent|newest joint)", said)


def test_a_run_that_ends_in_order_keeps_its_status(run):
    status, _, report = run("''")
    assert (status, report["outcome"]) == (1, "failure")  # the faulty planner plans no swing


def test_wrong_input_keeps_its_status(run):
    status, said, report = run("'' }\n  nonsense: {plugin: x")
    assert status == 2, said
    assert not report


def test_signals_reach_the_mission_through_its_supervisor(tmp_path, environment):
    text = MISSION.format(fault="''").split("      - run: ScanSwing")[0] + "      - wait: 600 s\n"
    (tmp_path / "dry.yaml").write_text(text, encoding="utf-8")
    words = ["run", "dry.yaml", "--run-dir=run", "--quiet", "--real-time", "--runner=thread"]
    with subprocess.Popen([*EXECUTIVE, *words], cwd=tmp_path, env=environment) as process:
        journal = tmp_path / "run" / "journal.jsonl"
        wait_until(lambda: journal.exists() and "node_started" in journal.read_text("utf-8"))
        process.send_signal(signal.SIGTERM)
        assert process.wait(30) == 1
    report = json.loads((tmp_path / "run" / "report.json").read_text(encoding="utf-8"))
    assert report["outcome"] == "stopped"


@pytest.mark.parametrize(
    ("verb", "how", "told"),
    [
        ("estimation.add_imu", "die", "the executive's process ended with exit status"),
        ("estimation.state", "die", "the executive's process ended with exit status"),
        ("robot.read", "hang", "the executive's loop has been silent for"),
    ],
)
def test_a_verb_that_the_loop_itself_calls_is_named(tmp_path, environment, verb, how, told):
    plugin, method = verb.split(".")
    faults = f"faults: [{{plugin: {plugin}, verb: {method}, how: {how}, at: 1 s}}]\n"
    limits = "loop: {heartbeat_limit: 2 s}\nwatch: {encoders: {do: stop, after: 60 s}}\n"
    text = WAITS + faults + limits
    done = run_of(tmp_path, environment, text, "--real-time", "--runner=thread")
    assert done.returncode == 3, done.stderr
    report = json.loads((tmp_path / "run" / "report.json").read_text(encoding="utf-8"))
    names = {"estimation": "gnss_imu_filter", "robot": "wire"}  # in a process of its own
    assert f"{plugin} plugin '{names[plugin]}' failed in '{method}': {told}" in report["reason"]
    assert re.search(r"\.py:\d+", report["reason"])
    assert report["reason"] in done.stderr
    assert (report["fault"]["capability"], report["fault"]["verb"]) == (plugin, method)


def test_a_run_whose_supervisor_is_killed_is_told_and_can_be_resumed(tmp_path, environment):
    (tmp_path / "dry.yaml").write_text(WAITS, encoding="utf-8")
    words = ["run", "dry.yaml", "--run-dir=run", "--quiet", "--real-time", "--runner=thread"]
    process = subprocess.Popen(
        [*EXECUTIVE, *words], cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True
    )
    with process:
        journal = tmp_path / "run" / "journal.jsonl"
        wait_until(lambda: journal.exists() and '"main/1' in journal.read_text(encoding="utf-8"))
        process.kill()
        assert process.wait(30) == -signal.SIGKILL
        said = process.stderr.read()  # up to the end of the other process
    report = json.loads((tmp_path / "run" / "report.json").read_text(encoding="utf-8"))
    assert "the supervisor, the first of the run's two processes, has ended" in report["reason"]
    assert report["reason"] in said
    assert "mission_ended" not in journal.read_text(encoding="utf-8")
    done = subprocess.run(
        [*EXECUTIVE, "resume", "run", "--quiet"],
        cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "run" / "report.json").read_text(encoding="utf-8"))
    assert report["outcome"] == "success"
