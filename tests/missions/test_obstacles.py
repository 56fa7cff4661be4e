"""A wall on the site: the lidars show it, and the chassis keeps off."""

import pytest

pytestmark = pytest.mark.mission

DRIVE = """
api: 1
mission: drive_to_a_wall
extends: base
plugins:
  robot:
    base: on_wheels
    site:
      terrain: {half_size_m: 20}
      stones: {count: 0}
      obstacles: [{at_m: [9, 0], size_m: [0.4, 8, 2]}]
  driving: dubins
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 40 deg, duration: 5 s}
      - run: MoveBase
        with: {place: [3 m, 0 m], heading: 0 deg}
      - run: MoveBase
        with: {place: [9 m, 0 m], heading: 0 deg}
"""


def test_the_chassis_drives_up_to_a_wall_and_not_into_it(run_mission):
    finished = run_mission(mission=DRIVE)
    assert len(finished.events("drive_ended")) == 1
    (failed,) = finished.events("drive_failed")
    assert failed["payload"]["trouble"] == "blocked"
    assert failed["payload"]["T_map_base"][0][3] < 3.1
    assert finished.report["outcome"] == "failure"
    assert finished.report["truth"]["collisions"] == []
