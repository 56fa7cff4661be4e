"""On the wall clock the simulated machine of a run lives in a process of its own."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from executive.mission.machine_process import listener_at
from executive.supervision.link import MachineLink

MISSION = """
api: 1
mission: apart
plugins:
  robot: {plugin: kinematic, model: m545, noise: true}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
loop: {heartbeat_limit: 2 s}  # the processors of tests are busy
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 60 deg, duration: DURATION}
"""
EXECUTIVE = [sys.executable, "-m", "executive.commands.entry"]
LIMIT_S = 120
SILENCE_S = 3.0  # one and a half times the heartbeat's limit
BRAKING_S = 1.5  # from 0.3 rad/s within the machine's own limits, in the time of its own clock
SLACK_S = 1.0  # of a busy computer


def words(folder, duration):
    (folder / "mission.yaml").write_text(MISSION.replace("DURATION", duration), encoding="utf-8")
    return [*EXECUTIVE, "run", "mission.yaml", "--run-dir=run", "--runner=thread", "--quiet"]


def awaited(found, limit_s=LIMIT_S):
    """Return what is found at last; fail if it is nothing."""
    until_s = time.monotonic() + limit_s
    while time.monotonic() < until_s:
        value = found()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError("it was not found in time")


def ended(folder, *line):
    return subprocess.run(
        line, cwd=folder, env=dict(os.environ), capture_output=True, text=True, timeout=LIMIT_S
    )


def test_a_run_starts_its_machine_and_ends_it(tmp_path):
    done = ended(tmp_path, *words(tmp_path, "2 s"), "--real-time")
    assert done.returncode == 0, done.stderr[-3000:]
    run = tmp_path / "run"
    address = (run / "machine.address").read_text().strip()
    assert listener_at(address) == 0
    assert "listens at" in (run / "machine.txt").read_text()
    report = json.loads((run / "report.json").read_text(encoding="utf-8"))
    assert report["plugins"]["robot"] == ["wire"]
    assert report["outcome"] == "success"


def test_a_machine_that_cannot_be_built_is_a_wrong_input(tmp_path):
    line = words(tmp_path, "2 s")
    text = (tmp_path / "mission.yaml").read_text()
    nowhere = "{plugin: mujoco, site: {stones: {placement: {min_radius_m: 9}}}}"
    changed = text.replace("{plugin: kinematic, model: m545, noise: true}", nowhere)
    (tmp_path / "mission.yaml").write_text(changed)
    done = ended(tmp_path, *line, "--real-time")
    assert done.returncode == 2
    assert "min_radius_m 9 is beyond max_radius_m" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.fixture
def swinging(tmp_path):
    """A run whose machine swings its cabin, in a group of its own; its folder and process."""
    line = [*words(tmp_path, "60 s"), "--real-time"]
    run, link = tmp_path / "run", MachineLink()
    with subprocess.Popen(line, cwd=tmp_path, start_new_session=True) as process:
        try:
            awaited(lambda: (run / "machine.address").is_file() and (run / "control.sock").exists())
            address = (run / "machine.address").read_text().strip()
            awaited(lambda: report_of(link, address).get("speed", 0.0) > 0.02)
            yield tmp_path, process, link, address
            machine = listener_at(address)
            if machine:
                os.kill(machine, signal.SIGTERM)
        finally:
            link.close()
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)


def report_of(link, address):
    link.keep(address)
    return link.report


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_the_machine_of_a_dead_or_frozen_executive_comes_to_rest(swinging, how):
    _, process, link, address = swinging
    os.killpg(process.pid, how)  # the executive and its supervisor, so that nobody else stops it
    driven_s = link.report["time_s"]
    stopped = awaited(lambda: report_of(link, address).get("latched") and dict(link.report))
    assert "the executive" in stopped["latched"]
    assert stopped["time_s"] - driven_s < SILENCE_S + SLACK_S
    rest = awaited(lambda: report_of(link, address)["at_rest"] and dict(link.report))
    assert rest["time_s"] - stopped["time_s"] < BRAKING_S + SLACK_S


def test_a_run_that_was_killed_is_resumed_in_the_same_world(swinging):
    folder, process, link, address = swinging
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(LIMIT_S)
    awaited(lambda: report_of(link, address).get("at_rest"))
    done = ended(folder, *EXECUTIVE, "resume", "run", "--quiet")
    assert done.returncode == 0, done.stderr[-3000:]
    assert listener_at(address) == 0  # the earlier process gave its world to another
    journal = (folder / "run" / "journal.jsonl").read_text(encoding="utf-8").splitlines()
    resumed = [json.loads(line) for line in journal if '"kind":"resumed"' in line]
    assert len(resumed) == 1
    assert "robot" in resumed[0]["payload"]["restored"]
