"""The judge on boxes whose limits are known by hand, thinned in time."""

import pytest
from executive_plugins.placing import judge

from executive.testing.exercises.building import bare, first_course


def test_three_boxes_on_level_ground_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judge, "_DRIFT_S", 0.5)
    monkeypatch.setattr(judge, "_TILT_MOST_DEG", 2.0)
    told = judge.RigidJudge().judge(first_course())
    assert told["fill"] == pytest.approx(3 * 0.96 * 0.7 * 0.4 / (3 * 0.8 * 0.9))
    assert told["height_m"] == pytest.approx(0.4)
    assert told["drift_20s_m"] < 0.005
    assert told["tilt_across_deg"] == 2.0
    assert told["load_across_lp"] == pytest.approx(0.7, abs=0.01)  # boxes slide before they topple


def test_nothing_has_no_figures_of_stability() -> None:
    told = judge.RigidJudge().judge(bare())
    assert (told["stones"], told["fill"]) == (0, 0.0)
    assert "drift_20s_m" not in told
