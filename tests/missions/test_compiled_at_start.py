"""No tick of a mission waits for a compiler: with the plugins of base.yaml, and with others."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.mission

SCRIPT = Path(__file__).parents[1] / "late_compilation.py"
MISSION = Path(__file__).with_name("one_stone.yaml")
THIN = (
    "robot.sensors.azimuth_stride=8",
    "mapping.slice_s=0.05",
    "robot.scenario=kind",
    "robot.site.stones.count=3",
)
CHOICES = {
    "base": (),
    "graphs": (
        "estimation.plugin=dual_graph",
        "odometry.plugin=scan_to_submap",
        "mapping.plugin=pose_graph",
        "registration.plugin=segment_fpfh",
        "alignment.plugin=point_to_plane",
        "grasping.plugin=sampled_antipodal",
    ),
    "filter": ("estimation.plugin=error_state_ekf", "odometry.plugin=kiss_icp"),
}


@pytest.mark.parametrize("chosen", CHOICES)
def test_all_that_a_mission_has_compiled_it_has_compiled_before_its_first_tick(chosen, tmp_path):
    ended = subprocess.run(
        [sys.executable, SCRIPT, "mission", MISSION, tmp_path / "run", *THIN, *CHOICES[chosen]],
        capture_output=True,
        text=True,
        timeout=800,
    )
    assert ended.returncode == 0, ended.stderr[-3000:]
    assert json.loads(ended.stdout.splitlines()[-1]) == []
