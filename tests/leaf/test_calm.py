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


def waited_s(mass_kg, amplitude, decay_s=np.inf, machine=ON_LEGS, phase=0.0, noise=0.01):
    """Return for how long is waited while the load sways by a share of its mass, at first."""
    clock, rng = SimpleNamespace(time_s=0.0), np.random.default_rng(1)
    turning = 2 * np.pi / Sway(ON_LEGS).period_s(SIDE, mass_kg)

    def payload_kg():
        sway = amplitude * np.exp(-clock.time_s / decay_s)
        sway *= np.cos(turning * clock.time_s + phase)
        return mass_kg * (1 + sway + noise * rng.normal())

    context = SimpleNamespace(
        machine=lambda: machine,
        arm=lambda: SIDE,
        now_s=lambda: clock.time_s,
        payload_kg=payload_kg if mass_kg else lambda: None,
    )
    for _ in calm(context, mass_kg or 0.7 * TIPPING_KG):
        clock.time_s += TICK_S
    return clock.time_s


def test_nobody_waits_where_nothing_yields_or_the_load_is_light():
    assert waited_s(0.7 * TIPPING_KG, 0.3, machine=M545) == 0.0
    assert waited_s(0.3 * TIPPING_KG, 0.9) == 0.0


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.0, 3.0, 4.5])
def test_a_load_that_hardly_sways_is_told_within_some_ticks(phase):
    """0.45 of the 0.3 that are left is 0.19 of the load."""
    assert waited_s(0.7 * TIPPING_KG, 0.1, phase=phase) == pytest.approx(5 * TICK_S, abs=TICK_S)


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.0, 3.0, 4.5])
def test_a_sway_that_is_too_far_is_waited_for_until_it_has_died_so_far(phase):
    """From 0.35 of the load to 0.19 of it, with a time constant of 1 s."""
    waited = waited_s(0.7 * TIPPING_KG, 0.35, decay_s=1.0, phase=phase)
    assert waited == pytest.approx(np.log(0.35 / 0.193), abs=0.3)


def test_a_sway_that_does_not_die_is_waited_for_no_longer_than_the_slowest_one():
    assert waited_s(0.7 * TIPPING_KG, 0.5) == pytest.approx(SLOWEST_S, abs=TICK_S)


def test_a_mass_that_no_monitor_tells_is_not_waited_for():
    assert waited_s(0.0, 0.5) == pytest.approx(TICK_S)
