"""Nothing is hard-coded to one machine: another one works by its folder's name alone."""

import pytest

from executive.mission.run import Options, Run
from executive.tree.load import load_mission

STONES = ["robot.model=mini", "robot.site.stones.count=1", "robot.site.stones.volume_m3=[0.1, 0.2]"]
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


def run(tmp_path, mission, overrides):
    return Run(load_mission(str(mission), overrides), Options(run_dir=tmp_path / "run")).execute(
        lambda mission: None
    )


def test_it_maps_its_site(tmp_path):
    result = run(
        tmp_path, "map_site", ["robot.model=mini", "robot.site.stones.volume_m3=[0.1, 0.2]"]
    )
    assert result.report["outcome"] == "success", result.report["reason"]
    assert result.report["counts"]["registrations_accepted"] == 1


@pytest.mark.mission
def test_it_picks_a_stone_straight_from_above(tmp_path):
    path = tmp_path / "vertical_pick.yaml"
    path.write_text(PICK)
    result = run(tmp_path, path, STONES)
    assert result.report["outcome"] == "success", result.report["reason"]
    assert [grasp["lifted"] for grasp in result.report["truth"]["grasps"]] == [True]
    assert result.report["truth"]["collisions"] == []
