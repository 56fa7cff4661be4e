"""Driving in the simulated world, on a map of the lidars and by the estimated pose."""

from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.mission

SHIPPED = (Path(__file__).parents[2] / "trees" / "examples" / "long_site.yaml").read_text()
STATIONS = "[{first}, {second}, {third}, {last}]"  # the machine stands at the first one

DRIVE = """
api: 1
mission: drive
extends: base
plugins:
  robot: {base: BASE, site: {terrain: {half_size_m: 20}, stones: {count: 0}}}
  driving: dubins
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 40 deg, duration: 5 s}
      - run: MoveBase
        with: {place: [5 m, -0.5 m], heading: 0 deg}
      - run: MoveBase
        with: {place: [30 m, 0 m], heading: 0 deg}
"""


@pytest.mark.parametrize("base", ["on_wheels", "on_legs"])
def test_it_drives_where_the_map_shows_ground_and_not_farther(run_mission, base):
    finished = run_mission(mission=DRIVE.replace("BASE", base))
    (ended,) = finished.events("drive_ended")
    assert ended["payload"]["off_m"] < 0.1
    (failed,) = finished.events("drive_failed")
    assert failed["payload"]["trouble"] == "unseen"
    assert np.linalg.norm(np.array(failed["payload"]["T_map_base"])[:2, 3] - [5.0, -0.5]) < 0.1
    assert finished.report["outcome"] == "failure"
    assert finished.report["truth"]["estimate"]["error_m"]["max"] < 0.03
    assert finished.report["truth"]["collisions"] == []


def test_a_long_site_without_stones_is_driven_to_its_end_and_is_a_failure(run_mission):
    assert STATIONS in SHIPPED
    shorter = SHIPPED.replace(STATIONS, "[{first}, {second}]")
    finished = run_mission("robot.site.stones.count=0", mission=shorter)
    assert len(finished.events("drive_ended")) == 1
    assert finished.report["outcome"] == "failure"
    assert "no stone is known" in finished.report["reason"]
    assert finished.report["truth"]["collisions"] == []
