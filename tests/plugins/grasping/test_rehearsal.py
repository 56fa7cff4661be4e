"""What rehearsals make of lifts, with lifts that are given instead of simulated."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from executive_plugins.grasping.rehearsal import Rehearsal, rehearsal_of
from executive_plugins.grasping.simulated_lift import Lifted
from executive_plugins.physics.belief import belief_of
from executive_plugins.physics.scenario import Scenario

from executive.geometry.rotation import log_so3
from executive.machine.machine import load_machine

GRIPPER = load_machine("m545").gripper
SHIFT_M, TURN_RAD = 0.02, 0.03
HELD, FALLEN = Lifted(0.01, 0.0, 0.0), Lifted(0.6, 0.0, 0.0)


class Given:
    """Lifts with outcomes that are known before, of a stone on any foot."""

    def __init__(self, outcomes: Iterable[Lifted]) -> None:
        self._outcomes = iter(outcomes)
        self._foot = 0.0
        self.feet: list[float] = []
        self.made: list[Any] = []

    def __getitem__(self, foot: float) -> "Given":
        self._foot = foot
        return self

    def lift(self, *asked: Any) -> Lifted:
        self.feet.append(self._foot)
        self.made.append(asked)
        return next(self._outcomes)


def rehearsal(scenario: Scenario) -> Rehearsal:
    return rehearsal_of(belief_of(scenario, GRIPPER), SHIFT_M, TURN_RAD)


def test_in_kind_a_first_fall_ends_the_lifts_and_costs_the_whole_prediction() -> None:
    kind, lifts = rehearsal("kind"), Given([FALLEN])
    seen = kind.lift(lifts, np.eye(4), 0.5)  # type: ignore[arg-type]
    assert len(lifts.made) == 1
    assert kind.score(1.0, True, seen) == pytest.approx(0.0)
    assert kind.rate_of(0.0) is None  # it is no rate
    assert kind.slips(seen, 0.3)


@pytest.mark.parametrize("scenario", ["nominal", "wet", "harsh"])
def test_elsewhere_one_fall_is_evidence_and_no_verdict(scenario: Scenario) -> None:
    drawn, lifts = rehearsal(scenario), Given([FALLEN, HELD, HELD, FALLEN])
    seen = drawn.lift(lifts, np.eye(4), 0.5)  # type: ignore[arg-type]
    assert len(lifts.made) == 4
    assert drawn.score(0.8, True, seen) == pytest.approx((2 * 0.8 + 2) / 6)
    assert drawn.rate_of(0.6) == 0.6
    assert drawn.score(0.8, True, seen) <= drawn.highest(0.8)
    assert drawn.score(0.0, False, seen) == pytest.approx(0.5)
    assert not drawn.slips(seen, 0.3)
    assert not drawn.is_firm(seen)


def test_a_grasp_that_falls_in_every_lift_is_refused_and_one_that_holds_in_all_is_firm() -> None:
    nominal = rehearsal("nominal")
    falls, holds = (nominal.lift(Given([one] * 4), np.eye(4), 0.5) for one in (FALLEN, HELD))  # type: ignore[arg-type]
    assert nominal.slips(falls, 0.3)
    assert not nominal.slips(falls, 0.5)  # a fall counts 0.5: nothing is refused then
    assert nominal.is_firm(holds)


def test_a_grasp_that_cannot_become_the_best_is_lifted_no_more_and_not_refused_for_it() -> None:
    nominal, lifts = rehearsal("nominal"), Given([FALLEN])
    best = nominal.highest(0.8)
    seen = nominal.lift(lifts, np.eye(4), 0.5, 0.8, best)  # type: ignore[arg-type]
    assert len(lifts.made) == seen.made == 1
    assert nominal.score(0.8, True, seen) == pytest.approx(2 * 0.8 / 3)
    assert nominal.score(0.8, True, seen) < best
    assert not nominal.slips(seen, 0.3)


@pytest.mark.parametrize(("worth", "to_beat"), [(0.8, 0.7), (None, 0.75), (0.8, -np.inf)])
def test_a_grasp_that_may_still_become_the_best_is_lifted_again(
    worth: float | None, to_beat: float
) -> None:
    nominal, lifts = rehearsal("nominal"), Given([FALLEN, HELD, HELD, HELD])
    seen = nominal.lift(lifts, np.eye(4), 0.5, worth, to_beat)  # type: ignore[arg-type]
    assert seen.made == 4
    assert nominal.score(worth or 0.0, worth is not None, seen) >= to_beat


def test_each_drawn_lift_has_another_foot_and_the_fixed_ones_go_straight_down() -> None:
    drawn, fixed = Given([HELD] * 4), Given([HELD] * 3)
    rehearsal("nominal").lift(drawn, np.eye(4), 0.5)  # type: ignore[arg-type]
    rehearsal("kind").lift(fixed, np.eye(4), 0.5)  # type: ignore[arg-type]
    assert tuple(drawn.feet) == rehearsal("nominal").feet == (1.0, 0.7, 0.4, 0.1)
    assert fixed.feet == [1.0, 1.0, 1.0]
    assert rehearsal("kind").feet == (1.0,)


def test_all_grasps_are_rehearsed_with_the_same_errors() -> None:
    first, second = Given([HELD] * 4), Given([HELD] * 4)
    rehearsal("nominal").lift(first, np.eye(4), 0.5)  # type: ignore[arg-type]
    rehearsal("nominal").lift(second, np.eye(4), 0.5)  # type: ignore[arg-type]
    for (T, _, contact), (T_again, _, contact_again) in zip(first.made, second.made, strict=True):
        assert np.array_equal(T, T_again)
        assert contact == contact_again


def test_drawn_lifts_have_a_friction_of_each_quarter_of_the_range_that_is_assumed() -> None:
    lifts = Given([HELD] * 4)
    rehearsal_of(belief_of("wet_to_dry", GRIPPER), SHIFT_M, TURN_RAD).lift(lifts, np.eye(4), 0.5)  # type: ignore[arg-type]
    frictions = sorted(contact.steel.friction for _, _, contact in lifts.made)
    for friction, least in zip(frictions, (0.25, 0.3, 0.35, 0.4), strict=True):
        assert least <= friction <= least + 0.05


def test_drawn_lifts_are_off_by_no_more_than_the_arm_is_said_to_be_and_use_most_of_it() -> None:
    lifts = Given([HELD] * 4)
    rehearsal("nominal").lift(lifts, np.eye(4), 0.5)  # type: ignore[arg-type]
    shifts = np.array([np.abs(T[:3, 3]) for T, _, _ in lifts.made])
    turns = np.array([np.abs(log_so3(T[:3, :3])) for T, _, _ in lifts.made])
    assert 0.5 * SHIFT_M < shifts.max() <= SHIFT_M
    assert 0.5 * TURN_RAD < turns.max() <= TURN_RAD * (1 + 1e-9)


def test_an_arm_without_errors_rehearses_the_planned_pose_itself() -> None:
    lifts = Given([HELD] * 4)
    rehearsal_of(belief_of("nominal", GRIPPER), 0.0, 0.0).lift(lifts, np.eye(4), 0.5)  # type: ignore[arg-type]
    assert all(np.array_equal(T, np.eye(4)) for T, _, _ in lifts.made)


@pytest.mark.parametrize(
    ("depth_m", "raised_m"), [(0.4, 0.1), (0.12, 0.06), (0.0, 0.0), (-0.1, 0.0)]
)
def test_the_best_is_lifted_again_raised_to_where_the_stone_was_seen_but_not_above_its_middle(
    depth_m: float, raised_m: float
) -> None:
    """With the same errors; the jaws start open, as the stone may be wider higher up."""
    drawn = rehearsal_of(belief_of("nominal", GRIPPER), 0.0, 0.0)
    lifts = Given([HELD] * 5 + [FALLEN])
    seen = drawn.lift(lifts, np.eye(4), 0.5)  # type: ignore[arg-type]
    seen = drawn.confirmed(lifts, np.eye(4), 0.5, depth_m, seen)  # type: ignore[arg-type]
    assert lifts.feet[4:] == [0.7, 0.4]
    assert [-T[0, 3] for T, _, _ in lifts.made] == pytest.approx([0.0] * 4 + [raised_m] * 2)
    assert [jaw for _, jaw, _ in lifts.made[4:]] == [GRIPPER.open_rad] * 2
    assert [one[2] for one in lifts.made[4:]] == [one[2] for one in lifts.made[1:3]]
    assert (seen.made, seen.lifted) == (6, pytest.approx(5 / 6))
    assert seen.slip_m == pytest.approx((5 * 0.01 + 0.5) / 6)
    assert seen.least_slip_m == pytest.approx(0.01)
    assert drawn.score(0.8, True, seen) == pytest.approx((2 * 0.8 + 5) / 8)


def test_lifts_that_ended_early_are_made_up_for_before() -> None:
    nominal, lifts = rehearsal("nominal"), Given([FALLEN] + [HELD] * 5)
    seen = nominal.lift(lifts, np.eye(4), 0.5, 0.8, nominal.highest(0.8))  # type: ignore[arg-type]
    assert seen.made == 1
    seen = nominal.confirmed(lifts, np.eye(4), 0.5, 0.3, seen)  # type: ignore[arg-type]
    assert lifts.feet == [1.0, 0.7, 0.4, 0.1, 0.7, 0.4]
    assert (seen.made, seen.lifted) == (6, pytest.approx(5 / 6))


def test_in_kind_nothing_is_lifted_again() -> None:
    kind, lifts = rehearsal("kind"), Given([HELD] * 3)
    seen = kind.lift(lifts, np.eye(4), 0.5)  # type: ignore[arg-type]
    assert kind.confirmed(lifts, np.eye(4), 0.5, 0.3, seen) is seen  # type: ignore[arg-type]
