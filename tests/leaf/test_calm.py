"""The wait for a sway that is too far for a machine that may tip to move on."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.leaf.calm import calm
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import load_machine
from executive.machine.stance import SLOWEST_S
from executive.machine.sway import Sway

M545 = load_machine("m545")
ON_LEGS = M545.model_copy(
    update={"stance": M545.stance.model_copy(update={"support_n_m": 2e6, "is_free": True})}
)
SIDE = M545.posture("carry") + np.pi / 2 * np.eye(7)[0]
TIPPING_KG = LiftCapacity(M545).at(SIDE).tipping_kg
TICK_S = 0.05


def waited_s(
    share_of_tipping, amplitude, *, decay_s=np.inf, machine=ON_LEGS, phase=0.0, noise_m=0.0002
):
    """Return for how long is waited while the load presses by a share of its mass more and less.

    The gripper goes down as far as the supports yield to what presses on them, about a level that
    nobody knows.
    """
    clock, rng = SimpleNamespace(time_s=0.0), np.random.default_rng(1)
    mass_kg, sway = share_of_tipping * TIPPING_KG, Sway(ON_LEGS)
    turning, sunk_m = 2 * np.pi / sway.period_s(SIDE, mass_kg), sway.sink_m(SIDE, mass_kg)

    def gripper():
        now = amplitude * np.exp(-clock.time_s / decay_s)
        now *= np.cos(turning * clock.time_s + phase)
        T_map_gripper = np.eye(4)
        T_map_gripper[2, 3] = 1.3 - sunk_m * now + noise_m * rng.normal()
        return T_map_gripper

    context = SimpleNamespace(
        machine=lambda: machine, arm=lambda: SIDE, now_s=lambda: clock.time_s, gripper=gripper
    )
    for _ in calm(context, mass_kg):
        clock.time_s += TICK_S
    return clock.time_s


HALF_A_PERIOD_S = Sway(ON_LEGS).period_s(SIDE, 0.7 * TIPPING_KG) / 2


def test_nobody_waits_where_nothing_yields_or_the_load_is_light():
    assert waited_s(0.7, 0.3, machine=M545) == 0.0
    assert waited_s(0.25, 0.9) == 0.0


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.0, 3.0, 4.5])
def test_a_load_that_hardly_sways_is_told_within_half_a_sway(phase):
    """0.4 of the 0.3 that are left is 0.17 of the load."""
    waited = waited_s(0.7, 0.1, phase=phase)
    assert HALF_A_PERIOD_S < waited <= HALF_A_PERIOD_S + 2 * TICK_S


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.0, 3.0, 4.5])
def test_a_sway_that_is_too_far_is_waited_for_until_it_has_died_so_far(phase):
    """From 0.5 of the load to 0.17 of it, with a time constant of 1 s, in the mean of a period."""
    waited = waited_s(0.7, 0.5, decay_s=1.0, phase=phase)
    assert waited == pytest.approx(np.log(0.5 / 0.171) + HALF_A_PERIOD_S, abs=0.3)


def test_a_sway_that_does_not_die_is_waited_for_no_longer_than_the_slowest_one():
    assert waited_s(0.7, 0.5) == pytest.approx(SLOWEST_S, abs=TICK_S)
