"""What the ground carries of a made-up hold, and what the rest weighs: silence while it does."""

import numpy as np
import pytest
from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.settings import HoldStateSettings

from executive.machine.kinematics import Kinematics
from executive.messages.ground_below import GroundBelow
from executive.messages.verdict import Trouble
from tests.plugins.monitoring.carries import (
    MASS_KG,
    Carry,
    lowered,
    only,
)


def test_says_nothing_over_jaws_that_hold_what_the_ground_carries(watch) -> None:
    carry = Carry()
    carry.weight[:] = 0.0
    assert watch(carry)[0] == []


def test_weighs_the_stone_and_tells_how_well(watch) -> None:
    weight = watch(Carry())[1].weight()
    assert weight.mass_kg == pytest.approx(MASS_KG, abs=3 * weight.std_kg)
    assert weight.std_kg < 0.05 * MASS_KG


@pytest.mark.parametrize("seed", range(3))
def test_an_arm_that_starts_and_stops_is_no_fall_of_a_stone_that_is_lighter_than_what_it_needs(
    watch, seed: int
) -> None:
    """A stone of 215 kg hangs; then the boom rises. To start and to stop an arm of some tonnes at
    0.5 rad/s², and the friction of its cylinder, need as much effort as 350 and 120 kg.
    """
    carry, begun_s, stopped_s = Carry(), 5.0, 6.5
    carry.mass_kg = 215.0
    rising = 0.2 * np.clip((carry.t - begun_s) / 0.4, 0.0, 1.0)
    rising *= 1 - np.clip((carry.t - stopped_s) / 0.4, 0.0, 1.0)
    carry.boom += rising
    needed_kg = 120.0 * (rising > 0) + 700.0 * np.gradient(rising, carry.t)
    carry.weight += needed_kg / carry.mass_kg
    told, monitor = watch(carry, seed, carried_s=4.5)
    assert told == []
    weight = monitor.weight()
    assert weight.mass_kg == pytest.approx(215.0, abs=3 * weight.std_kg)


def test_nothing_is_weighed_before_the_lift(watch) -> None:
    assert watch(Carry(0.9))[1].weight() is None


def test_says_nothing_when_the_ground_takes_over_and_the_arm_presses_on_it(watch) -> None:
    carry = Carry()
    carry.boom = np.where((carry.t > 6.0) & (carry.t < 8.0), -0.1, carry.boom)
    carry.weight *= 1 - 2.2 * carry.after(8.0, 0.5)
    carry.jaw -= 0.02 * carry.after(8.2, 0.3)  # it shifts as it is pressed
    assert watch(carry)[0] == []


def test_knows_that_the_ground_carries_the_stone_while_the_arm_still_sinks(watch) -> None:
    carry = lowered()
    carry.weight *= 1 - carry.after(7.0, 0.3)
    for until_s, stands in ((6.9, False), (7.5, True)):
        part = Carry(until_s)
        part.boom, part.weight = carry.boom[: len(part.t)], carry.weight[: len(part.t)]
        standing = watch(part)[1].standing()
        assert standing > 0.95 if stands else standing < 0.05


@pytest.mark.parametrize("seed", range(3))
def test_a_stone_that_is_lowered_hangs_until_the_ground_takes_over(watch, machine, seed) -> None:
    told = []
    monitor = HoldState(HoldStateSettings(), machine)
    monitor.start()
    assert monitor.standing() is None
    monitor.begin_hold()
    for sample in lowered().samples(machine, PayloadScale(machine), seed):
        monitor.update(sample)
        told.append(monitor.standing())
    assert told[0] is None
    assert max(one for one in told if one is not None) < 0.95


def test_a_stone_that_is_lowered_onto_the_ground_weighs_what_it_weighed_in_the_air(watch) -> None:
    """The ground takes over 40 % of it for longer than it was carried at rest."""
    carry = Carry(30.0)
    carry.boom = np.where((carry.t > 3.5) & (carry.t < 30.0), -0.005, carry.boom)
    carry.weight -= 0.4 * carry.after(5.0, ramp_s=1.0)
    told, monitor = watch(carry)
    assert told == []
    assert monitor.weight().mass_kg == pytest.approx(MASS_KG, rel=0.03)


@pytest.mark.parametrize(("late_s", "is_lost"), [(0.1, False), (1.5, False), (3.2, True)])
def test_what_leaves_the_jaws_long_after_they_sank_has_fallen(watch, late_s, is_lost) -> None:
    """The jaws press on for some tenths of a second on a stone that slides out of them."""
    carry, sunk_s = lowered(), 8.0
    carry.weight *= 1 - carry.after(sunk_s + late_s, 0.2)
    told, monitor = watch(carry, carried_s=4.0)
    assert [one.trouble for one in told] == ([Trouble.DROP] if is_lost else [])
    assert is_lost or monitor.standing() > 0.95
    assert all(one.stamp_s < sunk_s + late_s + 0.5 for one in told)


@pytest.mark.parametrize(("high_m", "is_lost"), [(0.1, False), (0.3, True), (1.0, True)])
def test_what_leaves_the_jaws_far_above_the_ground_has_fallen(
    watch, machine, high_m, is_lost
) -> None:
    """It does so in a sinking arm, so that nothing but the map tells that no ground carries it."""
    carry, sinking_s = lowered(), 7.0
    carry.weight *= 1 - carry.after(sinking_s, 0.2)
    q = next(
        one.position[:-1]
        for one in carry.samples(machine, PayloadScale(machine))
        if one.stamp_s >= sinking_s + 0.5
    )
    lowest_m = Kinematics(machine).gripper(q)[2, 3] - 0.5 - high_m
    below = GroundBelow(np.array([-20.0, -20.0]), np.full((160, 160), lowest_m), 0.5)
    told, monitor = watch(carry, carried_s=4.0, below=below)
    assert [one.trouble for one in told] == ([Trouble.DROP] if is_lost else [])
    assert is_lost or monitor.standing() > 0.95
    assert all(one.stamp_s <= sinking_s + 0.5 for one in told)


def test_a_stone_that_has_slipped_may_meet_the_ground_wherever_it_was_to_be(watch) -> None:
    """It hangs lower than its model: nobody knows any more how far above the ground it is."""
    carry = lowered()
    carry.jaw -= 0.03 * carry.after(5.0, 0.3)
    carry.weight *= 1 - carry.after(7.0, 0.2)
    below = GroundBelow(np.array([-20.0, -20.0]), np.full((160, 160), -5.0), 0.5)
    told, monitor = watch(carry, carried_s=4.0, below=below)
    assert only(told).trouble is Trouble.SLIP
    assert monitor.standing() > 0.95


def test_ground_that_was_not_seen_may_carry_a_stone(watch) -> None:
    carry = lowered()
    carry.weight *= 1 - carry.after(7.0, 0.2)
    unseen = GroundBelow(np.array([-20.0, -20.0]), np.full((160, 160), 1e6), 0.5)
    told, monitor = watch(carry, carried_s=4.0, below=unseen)
    assert told == []
    assert monitor.standing() > 0.95


def test_a_stone_that_slides_onto_the_ground_out_of_closing_jaws_is_a_slip(watch) -> None:
    """Its weight is gone, as if it had been set down, but the jaws have closed by decimetres."""
    carry = lowered()
    carry.weight *= 1 - carry.after(7.0, 0.2)
    carry.jaw -= 0.1 * carry.after(7.0, 0.4)
    told, monitor = watch(carry)
    verdict = only(told)
    assert (verdict.trouble, verdict.stamp_s <= 7.0 + 0.9) == (Trouble.SLIP, True)
    assert "slid onto the ground" in verdict.detail
    assert monitor.standing() > 0.95


@pytest.mark.parametrize("seed", range(3))
def test_an_arm_that_swings_up_after_a_fall_does_not_hide_it(watch, seed) -> None:
    """It lost its load: the drives push it up and down about where it hung."""
    carry = lowered()
    carry.force *= 1 - carry.after(7.0, 0.05)
    swing = np.cos(12 * (carry.t - 7.0)) * np.exp(-3 * np.clip(carry.t - 7.0, 0, None))
    carry.weight = np.where(carry.t > 7.0, 0.8 * swing, carry.weight)
    carry.jaw -= 0.1 * carry.after(7.0, 0.4)
    verdict = only(watch(carry, seed)[0])
    assert (verdict.trouble, verdict.stamp_s <= 7.0 + 0.5) == (Trouble.DROP, True)


def test_a_stone_that_has_slipped_is_weighed_no_more(watch) -> None:
    carry = Carry(16.0)
    carry.jaw -= 0.03 * carry.after(6.0, 0.3)
    carry.weight *= 1 - 0.4 * carry.after(6.5, 0.5)  # it touches the ground
    told, monitor = watch(carry)
    assert only(told).trouble is Trouble.SLIP
    weight = monitor.weight()
    assert weight.mass_kg == pytest.approx(MASS_KG, abs=3 * weight.std_kg)


def test_a_stone_that_slides_and_is_caught_weighs_as_before(watch) -> None:
    """It jerks at the arm for three tenths of a second, as the slip is told."""
    carry = Carry(16.0)
    carry.jaw -= 0.04 * carry.after(6.0, 0.2)
    carry.weight *= 1 - 0.3 * carry.after(6.0, 0.05) + 0.7 * carry.after(6.15, 0.05)
    carry.weight *= 1 - 0.4 / 1.4 * carry.after(6.5, 0.05)
    told, monitor = watch(carry)
    assert only(told).trouble is Trouble.SLIP
    assert monitor.weight().mass_kg == pytest.approx(MASS_KG, rel=0.03)


def test_what_hangs_for_good_is_the_weight_of_what_the_ground_carried_before(watch) -> None:
    carry = Carry(8.0)
    carry.weight[carry.t < 4.0] *= 0.75
    assert watch(carry)[1].weight().mass_kg == pytest.approx(MASS_KG, rel=0.03)


def test_a_stone_on_which_slack_jaws_are_pressed_is_not_lost(watch) -> None:
    """The stone has slid down in the jaws, which bear on it no more, and the arm presses on it."""
    carry = lowered()
    pressed = carry.after(7.0, 0.3)
    carry.weight *= 1 - 3.5 * pressed
    carry.force *= 1 - 0.9 * pressed
    told, monitor = watch(carry)
    assert Trouble.DROP not in [verdict.trouble for verdict in told]
    assert monitor.standing() > 0.95


def test_what_tears_a_stone_off_the_ground_is_no_weight(watch) -> None:
    carry = Carry(3.8)
    carry.boom[:] = 0.0
    carry.weight[carry.t < 3.0] *= 1.4
    assert watch(carry)[1].weight().mass_kg > 1.2 * MASS_KG
    assert watch(carry, carried_s=3.1)[1].weight().mass_kg == pytest.approx(MASS_KG, rel=0.03)
