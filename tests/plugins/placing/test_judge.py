"""The judge on boxes whose limits are known by hand, thinned in time."""

import numpy as np
import pytest
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.placing import judge
from executive_plugins.placing.stability_trials import StabilityTrials

from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.structure import Structure
from executive.testing.exercises.building import bare, box, first_course


def test_three_boxes_on_level_ground_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judge, "_DRIFT_S", 0.5)
    monkeypatch.setattr(judge, "_TILT_MOST_DEG", 2.0)
    told = judge.RigidJudge().judge(first_course())
    assert told["fill"] == pytest.approx(3 * 0.96 * 0.7 * 0.4 / (3 * 0.8 * 0.9), rel=0.04)
    assert told["height_m"] == pytest.approx(0.4)
    assert told["drift_20s_m"] < 0.005
    assert told["tilt_across_deg"] == 2.0
    assert told["load_across_lp"] == pytest.approx(0.7, abs=0.01)  # boxes slide before they topple


def test_nothing_has_no_figures_of_stability() -> None:
    told = judge.RigidJudge().judge(bare())
    assert (told["stones"], told["fill"]) == (0, 0.0)
    assert "drift_20s_m" not in told


class Told:
    """Trials that answer by the direction and the friction that they are asked for."""

    def __init__(self, built, rules) -> None:
        self.friction = rules.friction

    def tilt_deg(self, towards, most_deg):
        assert most_deg == 20.0
        return self.friction, *np.round(towards, 9)

    def drift_m(self, duration_s):
        return self.friction, duration_s

    pushed_m = load = lambda self, towards: (self.friction, *np.round(towards, 9))


@pytest.mark.parametrize("heading_deg", [0.0, 45.0, 120.0])
def test_a_wall_is_tried_along_and_across_its_own_line(
    heading_deg: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(judge, "StabilityTrials", Told)
    R = about_axis(np.array([0.0, 0.0, 1.0]), np.radians(heading_deg))
    wall = Structure("wall", np.array([[-1.5, 0.0], [1.5, 0.0]]) @ R[:2, :2].T, 0.8, 0.9)
    stone = StandingStone(box("one", 0.9, 0.6, 0.4), pose(R, np.array([0.0, 0.0, 0.2])))
    told = judge.RigidJudge().judge(AsBuilt(wall, bare().ground).with_standing(stone))
    along, across = (tuple(np.round(R[:, axis], 9)) for axis in (0, 1))
    assert told["tilt_along_deg"] == told["load_along_lp"] == (0.7, *along)
    assert told["tilt_across_deg"] == told["pushed_m"] == told["load_across_lp"] == (0.7, *across)
    assert told["tilt_across_slippery_deg"] == (0.5, *across)
    assert told["drift_20s_m"] == (0.7, 20.0)
    assert told["stones"] == 1


def test_a_tall_box_topples_at_the_slope_of_its_diagonal() -> None:
    tall = StandingStone(box("tall", 0.3, 0.3, 1.5), pose(t=np.array([0.0, 0.0, 0.75])))
    trials = StabilityTrials(bare().with_standing(tall), WorldRules(friction=0.7, pieces=1))
    limit_deg = np.degrees(np.arctan(0.3 / 1.5))
    across = np.array([0.0, 1.0, 0.0])
    assert limit_deg - 2.0 <= trials.tilt_deg(across, 20.0) <= limit_deg
    # One state serves all trials: after a fall the box stands again.
    assert trials.pushed_m(across) < 0.05
    assert trials.drift_m(1.0) < 0.005


@pytest.mark.parametrize("duration_s", [2.5, 4.0])
def test_drift_is_measured_over_the_time_that_was_asked_for(duration_s: float) -> None:
    """A stone in mid-air never rests, so that its trials begin while it falls."""
    high = StandingStone(box("high", 0.9, 0.6, 0.4), pose(t=np.array([0.0, 0.0, 200.0])))
    trials = StabilityTrials(bare().with_standing(high), WorldRules(friction=0.7, pieces=1))
    fallen_m = 0.5 * 9.81 * duration_s**2
    assert trials.drift_m(duration_s) == pytest.approx(fallen_m, rel=0.01)  # steps of some ms
    assert trials.drift_m(duration_s) == pytest.approx(fallen_m, rel=0.01)  # as the first time


PAIR = [
    (-0.45, 0.2, 0.9),
    (0.47, 0.2, 0.9),
]  # middle along the wall, height, length [m]; joint 0.01
THREE = [*PAIR, (1.39, 0.2, 0.9)]  # with a second joint at 0.93


@pytest.mark.parametrize(
    ("stones", "share"),
    [
        (PAIR, None),  # nothing lies above the joint
        ([*PAIR, (0.0, 0.6, 0.9)], 0.0),
        ([*PAIR, (-0.41, 0.6, 0.9)], 1.0),  # it ends 3 cm beyond the joint
        ([*PAIR, (-0.38, 0.6, 0.96)], 1.0),  # 9 cm beyond
        ([*PAIR, (-0.36, 0.6, 0.96)], 0.0),  # 11 cm beyond
        ([*PAIR, (-0.6, 0.6, 0.9)], None),  # 16 cm before the joint
        ([*PAIR, (0.0, 0.45, 0.9)], None),  # as good as of the same course
        ([(-0.45, 0.2, 0.9), (0.9, 0.2, 0.9), (0.2, 0.6, 0.9)], None),  # too wide for a joint
        ([*THREE, (0.0, 0.6, 0.9), (0.98, 0.6, 0.2)], 0.5),
        ([*THREE, (0.47, 0.6, 1.3)], 0.0),
    ],
)
def test_a_joint_runs_on_unless_a_higher_stone_covers_it(
    stones: list[tuple[float, float, float]], share: float | None
) -> None:
    wall = Structure("wall", np.array([[-1.5, 0.0], [2.5, 0.0]]), 0.8, 0.9)
    standing = [
        StandingStone(box(f"s{k}", length_m, 0.6, 0.4), pose(t=np.array([x_m, 0.0, z_m])))
        for k, (x_m, z_m, length_m) in enumerate(stones)
    ]
    assert judge._running_joints(AsBuilt(wall, bare().ground).with_standing(*standing)) == share


@pytest.mark.parametrize(("raised_m", "bears"), [(0.002, 0.7), (0.02, None)])
def test_stones_that_sway_off_the_ground_still_bear_and_those_above_it_do_not(
    raised_m: float, bears: float | None
) -> None:
    trials = StabilityTrials(first_course(), WorldRules(step_s=0.004, friction=0.7, pieces=1))
    trials._restore(trials._rest)
    trials._world.data.qpos[2::7] += raised_m
    trials._rest = trials._state()
    load = trials.load(np.array([1.0, 0.0, 0.0]))
    assert load == (bears if bears is None else pytest.approx(bears, abs=0.01))
