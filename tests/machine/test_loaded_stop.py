"""A stop with a load is no quicker than a machine on supports that yield bears."""

import numpy as np
import pytest

from executive.machine.loaded_stop import LoadedStop
from executive.machine.machine import load_machine
from executive.machine.stance import SLOWEST_S
from executive.machine.sway import Sway
from executive.machine.tipping_moment import TippingMoment

M545 = load_machine("m545")
ON_LEGS = M545.model_copy(
    update={"stance": M545.stance.model_copy(update={"support_n_m": 2e6, "is_free": True})}
)
SIDE = M545.posture("carry") + np.pi / 2 * np.eye(7)[0]


def least_s(speed: float, load_kg: float) -> float:
    """Return the time of a stop of the boom on its way down, at the side."""
    dq = np.zeros((1, len(M545.joints)))
    dq[0, 1] = -speed
    return LoadedStop(ON_LEGS).least_s(SIDE[None], dq, load_kg)


def test_a_slow_motion_may_be_stopped_at_once() -> None:
    assert least_s(0.01, 1000.0) == 0.0


def test_a_fast_one_takes_a_period_of_the_sway_at_least() -> None:
    period_s = Sway(ON_LEGS).period_s(SIDE, 1000.0)
    assert period_s <= least_s(0.3, 1000.0) < SLOWEST_S


@pytest.mark.parametrize("load_kg", [300.0, 1000.0, 1500.0])
def test_the_load_on_springs_leaves_half_of_what_holds_the_machine(load_kg: float) -> None:
    """The machine as a mass on a spring, of whose base the speed is taken in that time."""
    speed, step_s = 0.25, 1e-4
    moment, period_s = TippingMoment(ON_LEGS), Sway(ON_LEGS).period_s(SIDE, load_kg)
    momentum = np.abs(moment.momentum(SIDE, -speed * np.eye(7)[1], load_kg))
    stop_s = max(least_s(speed, load_kg), step_s)
    omega, off, rate, most = 2 * np.pi / period_s, 0.0, 0.0, 0.0
    for time_s in np.arange(0.0, 3.0, step_s):
        pressing = 1.0 / stop_s if time_s < stop_s else 0.0
        rate += (pressing - omega**2 * off) * step_s
        off += rate * step_s
        most = max(most, omega**2 * abs(off))
    left = moment.holding_nm(SIDE, load_kg)
    assert (most * momentum <= 0.51 * left).all()


def test_a_machine_that_a_load_tips_at_rest_stops_as_slowly_as_any() -> None:
    assert least_s(0.3, 20000.0) == SLOWEST_S
