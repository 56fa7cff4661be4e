"""A mission drives a machine that lives in another process, from the command line."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

MISSION = """
api: 1
mission: over_the_wire
plugins:
  robot: {plugin: kinematic, model: m545, noise: true}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
loop: {heartbeat_limit: 10 s}  # the processors of tests are busy
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 30 deg, duration: 3 s}
"""
EXECUTIVE = [sys.executable, "-m", "executive.commands.entry"]
LIMIT_S = 120


@pytest.fixture
def machine(tmp_path):
    """A simulated machine; its address."""
    (tmp_path / "mission.yaml").write_text(MISSION, encoding="utf-8")
    path = tmp_path / "machine.sock"
    words = ["simulate", "mission.yaml", "--address", f"unix:{path}", "--silence", "10 s"]
    with subprocess.Popen([*EXECUTIVE, *words], cwd=tmp_path) as process:
        limit_s = time.monotonic() + LIMIT_S
        while not path.exists() and time.monotonic() < limit_s and process.poll() is None:
            time.sleep(0.1)
        yield f"unix:{path}"
        process.send_signal(signal.SIGTERM)
        assert process.wait(LIMIT_S) == 0
    assert not path.exists()


def run(folder, *words):
    return subprocess.run(
        [*EXECUTIVE, "run", "mission.yaml", "--run-dir=run", "--runner=thread", "--quiet", *words],
        cwd=folder,
        env=dict(os.environ),
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
    )


def test_a_mission_drives_a_machine_in_another_process(tmp_path, machine):
    ended = run(tmp_path, "--machine", machine, "--set", "robot.silence_limit=10 s")
    assert ended.returncode == 0, ended.stderr[-3000:]
    report = json.loads((tmp_path / "run" / "report.json").read_text(encoding="utf-8"))
    assert report["outcome"] == "success"
    assert "truth" not in report  # the world is in another process


def test_without_a_machine_the_input_is_refused(tmp_path):
    (tmp_path / "mission.yaml").write_text(MISSION, encoding="utf-8")
    ended = run(tmp_path, "--machine", f"unix:{tmp_path}/nobody.sock")
    assert ended.returncode == 2
    assert "no machine listens at unix:" in ended.stderr
    assert "executive simulate" in ended.stderr
