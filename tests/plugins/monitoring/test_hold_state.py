"""Made-up holds of a machine that lifts, carries, sets down, loses: silence over good ones, one
verdict on bad ones.
"""

import numpy as np
import pytest
from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.jaw_slip import JawSlip
from executive_plugins.monitoring.payload_drop import PayloadDrop
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.settings import HoldStateSettings

from executive.arrays import Float
from executive.machine.machine import Machine, load_machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict

RATE_HZ = 50
HELD_RAD, FORCE = 0.5, 88e3  # the jaws' angle [rad] and the effort with which they press [N·m]
MASS_KG = 1800.0
FAULT_S = 8.0


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(scope="module")
def scale(machine: Machine) -> PayloadScale:
    return PayloadScale(machine)


class Carry:
    """A hold of some seconds, as signals that a test may change: share of the weight, jaws' angle
    [rad], their force [N·m], speed of the boom [rad/s]. The arm lifts after one second.
    """

    def __init__(self, duration_s: float = 12.0) -> None:
        self.t = np.arange(round(duration_s * RATE_HZ)) / RATE_HZ
        self.weight = np.clip(2 * (self.t - 1.0), 0.0, 1.0)
        self.jaw = np.full(len(self.t), HELD_RAD)
        self.force = np.full(len(self.t), FORCE)
        self.boom = np.where((self.t > 1.0) & (self.t < 2.5), 0.1, 0.0)
        self.mass_kg = MASS_KG

    def after(self, time_s: float, ramp_s: float = 0.02) -> Float:
        """Return a step from 0 to 1."""
        return np.asarray(np.clip((self.t - time_s) / ramp_s, 0.0, 1.0))

    def samples(self, machine: Machine, scale: PayloadScale, seed: int = 0) -> list[JointSample]:
        rng = np.random.default_rng(seed)
        noise = next(one.effort_noise for one in machine.sensors_of("encoders"))
        limits = np.array([joint.max_effort for joint in machine.joints] + [machine.jaw.max_effort])
        q = machine.posture("carry")
        q[1] = 0.6
        series = []
        for i, stamp_s in enumerate(self.t):
            q[1] += self.boom[i] / RATE_HZ
            position = np.append(q, self.jaw[i] + rng.normal(0, 2e-4))
            lever = scale.lever(q)
            effort = scale.empty_effort(position) + self.mass_kg * self.weight[i] * lever
            effort = np.append(effort, -self.force[i]) + rng.normal(0.0, noise * limits)
            velocity = rng.normal(0.0, 2e-3, len(position))
            velocity[1] += self.boom[i]
            series.append(JointSample(stamp_s, machine.joint_names, position, velocity, effort))
        return series


@pytest.fixture
def watch(machine: Machine, scale: PayloadScale):
    """Return a function from a carry to the verdicts on it, and the monitor."""

    def watched(
        carry: Carry,
        seed: int = 0,
        kind: type[HoldState] = HoldState,
        carried_s: float = np.inf,
    ):
        monitor = kind(kind.Settings(), machine)
        monitor.start()
        monitor.begin_hold()
        told = []
        for one in carry.samples(machine, scale, seed):
            if one.stamp_s > carried_s:
                monitor.begin_carry()
                carried_s = np.inf
            told.append(monitor.update(one))
        return [verdict for verdict in told if verdict is not None], monitor

    return watched


def only(told: list[Verdict]) -> Verdict:
    (verdict,) = told
    return verdict


@pytest.mark.parametrize("seed", range(3))
def test_says_nothing_over_half_a_minute_of_carrying(watch, seed: int) -> None:
    assert watch(Carry(30.0), seed)[0] == []


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


def test_says_nothing_when_the_ground_takes_over_and_the_arm_presses_on_it(watch) -> None:
    carry = Carry()
    carry.boom = np.where((carry.t > 6.0) & (carry.t < 8.0), -0.1, carry.boom)
    carry.weight *= 1 - 2.2 * carry.after(8.0, 0.5)
    carry.jaw -= 0.02 * carry.after(8.2, 0.3)  # it shifts as it is pressed
    assert watch(carry)[0] == []


def lowered() -> Carry:
    """Return a carry whose boom sinks between the 6th and the 8th second."""
    carry = Carry()
    carry.boom = np.where((carry.t > 6.0) & (carry.t < 8.0), -0.1, carry.boom)
    return carry


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


@pytest.mark.parametrize(("late_s", "is_lost"), [(0.1, False), (1.5, True)])
def test_what_leaves_the_jaws_long_after_they_sank_has_fallen(watch, late_s, is_lost) -> None:
    """The jaws press on for some tenths of a second on a stone that slides out of them."""
    carry, sunk_s = lowered(), 8.0
    carry.weight *= 1 - carry.after(sunk_s + late_s, 0.2)
    told, monitor = watch(carry, carried_s=4.0)
    assert [one.trouble for one in told] == ([Trouble.DROP] if is_lost else [])
    assert is_lost or monitor.standing() > 0.95
    assert all(one.stamp_s < sunk_s + late_s + 0.5 for one in told)


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


def test_what_tears_a_stone_off_the_ground_is_no_weight(watch) -> None:
    carry = Carry(3.8)
    carry.boom[:] = 0.0
    carry.weight[carry.t < 3.0] *= 1.4
    assert watch(carry)[1].weight().mass_kg > 1.2 * MASS_KG
    assert watch(carry, carried_s=3.1)[1].weight().mass_kg == pytest.approx(MASS_KG, rel=0.03)


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
