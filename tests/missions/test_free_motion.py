"""An arm that carries nothing meets a block of which its map knows nothing."""

import pytest

pytestmark = pytest.mark.mission

ABOVE = "{J_TURN: 0, J_BOOM: 0.546, J_DIPPER: 0.75, J_TELE: 0, J_EE_PITCH: -1.436, J_EE_YAW: 0}"
BELOW = "{J_TURN: 0, J_BOOM: 0.448, J_DIPPER: 0.566, J_TELE: 0, J_EE_PITCH: -1.154, J_EE_YAW: 0}"
DOWN = f"""
api: 1
mission: press
extends: base
plugins:
  robot:
    scenario: nominal
    base: on_legs
    site: {{stones: {{count: 0}}, obstacles: [{{at_m: [5.5, -0.28], size_m: [1.5, 1.5, 0.8]}}]}}
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: GoToPosture
        with: {{joints: {ABOVE}}}
      - run: GoToPosture
        with: {{joints: {BELOW}}}
"""


def test_it_stops_and_fails_and_does_not_go_on_pressing(run_mission):
    """At this speed the block has lifted two legs before the arm stands: for a moment alone."""
    finished = run_mission(mission=DOWN)
    assert finished.report["outcome"] == "failure"
    assert "the arm presses on something" in finished.report["reason"]
    limits = finished.report["truth"]["limits"]
    (tipping,) = [one for one in limits if one["kind"] == "tipping"]
    assert tipping["largest_share"] > 0.5
    assert tipping["beyond_s"] < 0.6
