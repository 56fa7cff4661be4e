"""Missions on the simulated site: the same seed gives the same journal;
hopeless sites end clearly.
"""

import pytest

from executive.journal import read_journal
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

QUICK = """
api: 1
mission: quick
extends: base
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: SurveySite
      - run: ScanSwing
        with: {angle: 90 deg, duration: 6 s}
      - optional: true
        do: {run: RegisterDroneMap}
      - run: Segment
      - run: FindSlots
        with: {count: 2}
"""


# One firing in eight: the missions' logic is under test, not the lidars' density.
THIN = "robot.sensors.azimuth_stride=8"


def run(tmp_path, mission, *overrides, name="run", **options):
    made = Run(
        load_mission(str(mission), [THIN, *overrides]), Options(run_dir=tmp_path / name, **options)
    )
    return made.execute(lambda mission: None)


@pytest.fixture
def quick(tmp_path):
    path = tmp_path / "quick.yaml"
    path.write_text(QUICK)
    return path


def test_the_same_seed_gives_the_same_journal_over_all_runners(tmp_path, quick):
    journals = {
        runner: run(tmp_path, quick, name=runner, runner=runner).folder.journal.read_bytes()
        for runner in ("inline", "thread", "process")
    }
    assert journals["inline"] == journals["thread"] == journals["process"]
    other = run(tmp_path, quick, name="other", seed=2).folder.journal.read_bytes()
    assert other != journals["inline"]


def test_an_empty_site_is_a_failure_that_says_so(tmp_path):
    result = run(tmp_path, "pick_and_place", "robot.site.stones.count=0")
    assert (result.report.outcome, result.exit_status) == ("failure", 1)
    assert "no stone was found on the site" in result.report.reason


def test_stones_out_of_reach_are_set_aside_with_the_reason(tmp_path):
    far = ("count=1", "placement.min_radius_m=9.2", "placement.max_radius_m=10.5")
    stones = [f"robot.site.stones.{setting}" for setting in far]
    # The other scenarios draw no stone that the machine cannot lift where it lies.
    result = run(tmp_path, "pick_and_place", "robot.scenario=kind", *stones)
    assert (result.report.outcome, result.exit_status) == ("failure", 1)
    assert "0 of 1 stones placed; set aside: 1" in result.report.reason
    assert "out_of_reach" in result.report.picks[0].set_aside


def test_an_unreadable_drone_cloud_ends_before_anything_moves(tmp_path):
    cloud = tmp_path / "drone.ply"
    cloud.write_text("ply\nformat ascii 1.0\nelement vertex 3\n")
    chosen = ("surveying.plugin=point_cloud_file", f"surveying.path={cloud}")
    result = run(tmp_path, "map_site", *chosen)
    assert (result.report.outcome, result.exit_status) == ("failure", 1)
    assert "drone.ply" in result.report.reason
    assert [
        entry for entry in read_journal(result.folder.journal) if entry.kind == "site_scanned"
    ] == []
