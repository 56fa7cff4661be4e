"""Made-up holds that go well, or do not: silence over good ones, one verdict on bad ones."""

import numpy as np
import pytest
from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.jaw_slip import JawSlip
from executive_plugins.monitoring.payload_drop import PayloadDrop
from executive_plugins.monitoring.settings import HoldStateSettings

from executive.machine.machine import Machine
from executive.messages.verdict import Trouble
from tests.plugins.monitoring.carries import (
    FAULT_S,
    HELD_RAD,
    Carry,
    only,
)


@pytest.mark.parametrize("seed", range(3))
def test_says_nothing_over_half_a_minute_of_carrying(watch, seed: int) -> None:
    assert watch(Carry(30.0), seed)[0] == []


@pytest.mark.parametrize("seed", range(3))
def test_tells_jaws_that_lose_pressure_and_open_within_half_a_second(watch, seed: int) -> None:
    carry = Carry()
    carry.force *= 1 - carry.after(FAULT_S, 0.05)
    carry.weight *= 1 - carry.after(FAULT_S + 0.05, 0.1)
    carry.jaw += 0.3 * carry.after(FAULT_S + 0.05, 1.0)
    verdict = only(watch(carry, seed)[0])
    assert verdict.trouble is Trouble.DROP
    assert FAULT_S < verdict.stamp_s <= FAULT_S + 0.5
    for evidence in ("lost (p = ", "kg left of 1", "of the force"):
        assert evidence in verdict.detail


def test_tells_a_stone_that_stays_in_jaws_that_have_opened(watch) -> None:
    """The weight is still there, on jaws that no longer press: it will fall later."""
    carry = Carry()
    carry.force *= 1 - carry.after(FAULT_S, 0.05)
    carry.jaw += 0.05 * carry.after(FAULT_S, 0.2)
    verdict = only(watch(carry)[0])
    assert verdict.trouble is Trouble.DROP
    assert verdict.stamp_s <= FAULT_S + 0.5
    assert "opening" in verdict.detail


def test_tells_a_loss_of_pressure_while_the_stone_is_still_held_as_a_slip(watch) -> None:
    carry = Carry()
    carry.force *= 1 - 0.7 * carry.after(FAULT_S, 0.05)
    verdict = only(watch(carry)[0])
    assert verdict.trouble is Trouble.SLIP
    assert verdict.stamp_s <= FAULT_S + 0.5
    assert "pressing with 30% of the force" in verdict.detail


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("within_s", "is_told"), [(0.15, True), (3.0, False)])
def test_tells_a_stone_that_forces_the_jaws_apart_at_once_and_rests(
    watch, machine: Machine, seed: int, within_s: float, is_told: bool
) -> None:
    """It slides by jerks. One whose jaws open as far in seconds has shifted as it was swung."""
    hold = machine.gripper
    wider_rad = hold.jaw_rad(hold.opening_m(HELD_RAD) + 0.01) - HELD_RAD
    carry = Carry()
    carry.jaw += wider_rad * carry.after(FAULT_S, within_s)
    told = watch(carry, seed)[0]
    assert [one.trouble for one in told] == [Trouble.SLIP] * is_told
    assert all(FAULT_S < one.stamp_s <= FAULT_S + 0.5 for one in told)


def test_a_stone_that_falls_while_the_jaws_snap_shut_is_one_event(watch) -> None:
    carry = Carry()
    carry.force *= 1 - carry.after(FAULT_S, 0.05)
    carry.weight *= 1 - carry.after(FAULT_S, 0.1)
    carry.jaw -= 0.5 * carry.after(FAULT_S, 1.1)
    verdict = only(watch(carry)[0])
    assert verdict.trouble is Trouble.DROP
    assert verdict.stamp_s <= FAULT_S + 0.5


def test_a_slip_that_ends_in_a_fall_is_followed_by_the_fall(watch) -> None:
    carry = Carry()
    carry.jaw -= 0.03 * carry.after(6.0, 0.3)
    carry.weight *= 1 - carry.after(FAULT_S, 0.1)
    carry.force *= 1 - carry.after(FAULT_S, 0.1)
    carry.jaw -= 0.4 * carry.after(FAULT_S, 1.0)
    told = watch(carry)[0]
    assert [verdict.trouble for verdict in told] == [Trouble.SLIP, Trouble.DROP]
    assert 6.0 < told[0].stamp_s <= 6.6
    assert FAULT_S < told[1].stamp_s <= FAULT_S + 0.5


def test_says_nothing_while_a_lifted_stone_settles_by_a_quarter_of_a_metre(watch) -> None:
    carry = Carry()
    carry.jaw -= 0.12 * carry.after(1.5, 0.6)
    assert watch(carry)[0] == []


@pytest.mark.parametrize("closes", [1, -1])
def test_tells_jaws_that_move_after_the_trial_within_half_a_second(watch, closes: int) -> None:
    """Before it, a stone may settle; once it hangs, it does not, and what follows is a slip."""
    carry = Carry()
    carry.jaw -= closes * 0.02 * carry.after(3.0, 0.2)
    assert watch(carry)[0] == []
    verdict = only(watch(carry, carried_s=2.7)[0])
    assert verdict.trouble is Trouble.SLIP
    assert 3.0 < verdict.stamp_s <= 3.5


def test_tells_a_fall_while_the_jaws_still_press(watch) -> None:
    """A stone that slides out of wet jaws takes some tenths of a second to leave them."""
    carry = Carry()
    carry.weight *= 1 - carry.after(FAULT_S, 0.1)
    carry.force *= 1 - carry.after(FAULT_S + 1.0, 0.1)
    verdict = only(watch(carry)[0])
    assert verdict.trouble is Trouble.DROP
    assert FAULT_S < verdict.stamp_s <= FAULT_S + 0.5


def test_a_carry_without_a_hold_is_none(machine: Machine) -> None:
    monitor = HoldState(HoldStateSettings(), machine)
    monitor.start()
    monitor.begin_carry()
    assert monitor.weight() is None


def test_says_nothing_about_creep_of_a_millimetre_a_second(watch, machine: Machine) -> None:
    carry = Carry(30.0)
    carry.jaw -= 1e-3 / (2 * machine.gripper.tip_radius_m) * carry.t
    assert watch(carry)[0] == []


def test_tells_slow_slip_in_the_end(watch, machine: Machine) -> None:
    carry = Carry(40.0)
    carry.jaw -= 2.5e-3 / (2 * machine.gripper.tip_radius_m) * carry.t
    assert only(watch(carry)[0]).trouble is Trouble.SLIP


def test_says_nothing_while_the_arm_accelerates(watch) -> None:
    """The efforts of an arm that speeds up and brakes are a fifth off."""
    carry = Carry()
    carry.boom += 0.1 * np.sin(6 * carry.t) * (carry.t > 4.0)
    carry.weight *= 1 + 0.2 * np.cos(6 * carry.t) * (carry.t > 4.0)
    assert watch(carry)[0] == []


def test_tells_jaws_that_hold_nothing(watch) -> None:
    carry = Carry(3.0)
    carry.weight[:] = 0.0
    carry.jaw[:] = 0.0
    told = only(watch(carry)[0])
    assert told.trouble is Trouble.EMPTY
    assert told.detail.startswith("nothing is between the jaws; ")


def test_closed_jaws_with_a_stone_within_them_hold_it_until_it_falls(watch) -> None:
    """They press on each other, and close no further when it falls: its weight alone tells."""
    carry = Carry()
    carry.jaw[:], carry.weight[:] = 0.0, 1.0  # it was weighed before the hold began
    carry.force *= np.linspace(1.0, 0.2, len(carry.force))  # they press on each other and its stop
    assert watch(carry)[0] == []
    carry.weight *= 1 - carry.after(FAULT_S)
    fallen = only(watch(carry)[0])
    assert fallen.trouble is Trouble.DROP
    assert FAULT_S < fallen.stamp_s < FAULT_S + 0.6


def test_jaws_that_close_where_a_stone_fell_out_have_lost_it(watch) -> None:
    """The angle alone says that nothing is held; what became of the stone is as sure, and told."""
    carry = Carry()
    fallen = carry.after(FAULT_S)
    for signal in (carry.force, carry.weight, carry.jaw):
        signal *= 1 - fallen
    verdict = only(watch(carry)[0])
    assert verdict.trouble is Trouble.DROP
    assert verdict.detail.startswith("lost (p = ")


def test_without_measured_jaw_forces_weight_and_jaws_tell(watch) -> None:
    fallen, set_down = Carry(), Carry()
    for carry in (fallen, set_down):
        carry.force[:] = 0.0
    fallen.weight *= 1 - fallen.after(FAULT_S, 0.1)
    set_down.boom = np.where((set_down.t > 6.0) & (set_down.t < 8.0), -0.1, set_down.boom)
    set_down.weight *= 1 - set_down.after(8.0, 0.5)
    assert only(watch(fallen)[0]).trouble is Trouble.DROP
    assert watch(set_down)[0] == []


def test_a_sample_twice_or_out_of_order_changes_nothing(machine: Machine, scale) -> None:
    carry = Carry()
    carry.weight *= 1 - carry.after(FAULT_S, 0.1)
    carry.force *= 1 - carry.after(FAULT_S, 0.1)
    series, told = carry.samples(machine, scale), []
    twice = [one for i in range(1, len(series)) for one in (series[i], series[i - 1])]
    for mixed in (series[1:], twice):
        monitor = HoldState(HoldStateSettings(), machine)
        monitor.start()
        monitor.begin_hold()
        told.append([v.stamp_s for one in mixed if (v := monitor.update(one)) is not None])
    assert told[0] == told[1] != []


def test_is_silent_before_and_after_a_hold_and_starts_anew_with_the_next(
    machine: Machine, scale
) -> None:
    carry = Carry()
    carry.jaw -= 0.3 * carry.after(6.0, 0.3)
    series = carry.samples(machine, scale)
    monitor = HoldState(HoldStateSettings(), machine)
    monitor.start()
    assert not any(monitor.update(one) for one in series)
    for _ in range(2):
        monitor.begin_hold()
        assert any(monitor.update(one) for one in series)
    monitor.end_hold()
    assert not any(monitor.update(one) for one in series)


@pytest.mark.parametrize(("kind", "told"), [(JawSlip, Trouble.SLIP), (PayloadDrop, Trouble.DROP)])
def test_slips_and_falls_can_be_asked_for_apart(watch, kind, told) -> None:
    slipping, falling = Carry(), Carry()
    slipping.jaw -= 0.03 * slipping.after(6.0, 0.3)
    falling.weight *= 1 - falling.after(6.0, 0.1)
    falling.force *= 1 - falling.after(6.0, 0.1)
    found = [one for carry in (slipping, falling) for one in watch(carry, kind=kind)[0]]
    verdict = only(found)
    assert (verdict.trouble, verdict.monitor) == (told, kind.name)
