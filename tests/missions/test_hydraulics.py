"""An arm with valves and a shared pump moves a stone, though it follows a dead time late."""

import pytest

pytestmark = pytest.mark.mission


def test_a_stone_is_placed_with_hydraulic_joints(run_mission):
    finished = run_mission(
        "robot.site.stones.count=1", "robot.drive=hydraulic", "motion.oil_flow=limited"
    )
    assert finished.report["outcome"] == "success", finished.report["reason"]
    (stone,) = finished.report["truth"]["stones"]
    assert stone["slot_error_m"] < 0.3
    assert finished.report["truth"]["collisions"] == []
    (verified,) = finished.events("placement_verified")
    assert verified["payload"]["seen"] == "placed"
