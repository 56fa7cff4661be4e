"""Nothing is hard-coded to one machine: another one works by its folder's name alone, and what was
recorded of its run can be used.
"""

import json

import numpy as np
import pytest

pytestmark = pytest.mark.mission

MACHINE = ["robot.model=mini", "robot.site.stones.volume_m3=[0.1, 0.2]"]
PICK = """
api: 1
mission: vertical_pick
extends: base
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 170 deg, duration: 10 s}
      - run: Segment
      - check: SelectLargest
      - run: PlanGrasp
      - run: PlanPick
      - run: OpenGripper
      - run: ExecuteTrajectory
      - run: CloseGripper
      - run: PlanRetreat
        with: {height: 1 m}
      - reactive_sequence:
          - check: DetectSlip
          - run: ExecuteTrajectory
"""


@pytest.fixture(scope="module")
def mapped(run_mission):
    return run_mission(*MACHINE, mission="map_site")


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return tmp_path_factory.mktemp("log") / "run.mcap"


@pytest.fixture(scope="module")
def picked(run_mission, log):
    stone = "robot.site.stones.count=1"
    return run_mission(*MACHINE, stone, mission=PICK, record=True, record_log=log)


def test_it_maps_its_site(mapped):
    assert mapped.report["outcome"] == "success", mapped.report["reason"]
    assert mapped.report["counts"]["registrations_accepted"] == 1


def test_each_stone_of_the_site_is_known_where_it_lies(mapped):
    stones = mapped.report["truth"]["stones"]
    assert all(stone["held_object"] is not None for stone in stones)
    assert max(stone["database_error_m"] for stone in stones) < 0.05


def test_it_picks_a_stone_straight_from_above(picked):
    assert picked.report["outcome"] == "success", picked.report["reason"]
    assert [grasp["lifted"] for grasp in picked.report["truth"]["grasps"]] == [True]
    assert picked.report["truth"]["collisions"] == []


def test_the_recording_for_the_viewer_is_there(picked):
    assert (picked.folder / "recording.rrd").read_bytes()[:3] == b"RRF"


def test_the_log_of_the_run_is_estimated_anew(picked, log, tmp_path, command_line):
    out = tmp_path / "trajectory.tum"
    answer = command_line("estimate", str(log), "--out", str(out), "--json")
    assert answer.status == 0, answer.err
    assert json.loads(answer.out)["states"][-1]["status"] == "GLOBAL"
    trajectory = np.loadtxt(out)
    assert trajectory[-1, 0] - trajectory[0, 0] > 0.8 * picked.report["ended_s"]
