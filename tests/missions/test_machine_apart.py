"""On the wall clock a mission works in the simulated world of another process, which judges it."""

import json
import os
import subprocess
import sys

MISSION = """
api: 1
mission: seen_from_apart
extends: base
loop: {heartbeat_limit: 10 s}  # the processors of tests are busy
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: SurveySite
        out: {survey: "{survey}"}
      - run: ScanSwing
        with: {angle: 60 deg, duration: 6 s}
      - run: Segment
"""
LIMIT_S = 600


def test_a_survey_comes_over_the_wire_and_the_truth_from_the_machine(tmp_path, thin):
    (tmp_path / "mission.yaml").write_text(MISSION, encoding="utf-8")
    settings = (*thin, "robot.site.stones.count=2")
    ended = subprocess.run(
        [
            *(sys.executable, "-m", "executive.commands.entry", "run", "mission.yaml"),
            *("--real-time", "--run-dir=run", "--quiet", "--seed=13101"),
            *(word for setting in settings for word in ("--set", setting)),
        ],
        cwd=tmp_path,
        env=dict(os.environ),
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
    )
    assert ended.returncode == 0, ended.stderr[-3000:]
    run = tmp_path / "run"
    report = json.loads((run / "report.json").read_text(encoding="utf-8"))
    truth = report["truth"]
    assert len(truth["stones"]) == 2
    assert truth["collisions"] == []
    assert truth["estimate"]["error_m"]["max"] < 0.1  # the clocks of both processes agree
    assert truth["map"]["distance_m"]["median"] < 0.03  # as in lock-step
    surveyed = [
        json.loads(line)["payload"]
        for line in (run / "journal.jsonl").read_text(encoding="utf-8").splitlines()
        if '"kind":"site_surveyed"' in line
    ]
    assert [one["points"] > 0 for one in surveyed] == [True]
