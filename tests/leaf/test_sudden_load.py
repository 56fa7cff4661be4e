"""What jaws lift as they close, and whether it comes on faster than the machine can bear it."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.leaf.sudden_load import SuddenLoad
from executive.machine.machine import load_machine
from executive.machine.stance import SLOWEST_S
from executive.machine.sway import Sway
from executive.machine.tipping_moment import TippingMoment

M545 = load_machine("m545")
ON_LEGS = M545.model_copy(
    update={"stance": M545.stance.model_copy(update={"support_n_m": 2e6, "is_free": True})}
)
SIDE = M545.posture("carry") + np.pi / 2 * np.eye(7)[0]
MOMENT = TippingMoment(M545)
NEWTON = MOMENT.tipping_nm(SIDE, np.array([0.0, 0.0, -1.0])) / MOMENT.holding_nm(SIDE, 0.0)
TIPPING_N = 1.0 / NEWTON.max()
TICK_S = 0.05


def weight(share):
    """Return the force of what presses by a share of what tips the machine [N]."""
    return np.array([0.0, 0.0, -share * TIPPING_N])


def too_sudden(share_at, until_s=10.0, machine=ON_LEGS):
    """Return at which looks a load is too sudden, of which the share is a function of time."""
    load = SuddenLoad(SimpleNamespace(machine=lambda: machine))
    times_s = np.arange(0.0, until_s, TICK_S)
    told = [load.is_too_sudden(at_s, SIDE, weight(share_at(at_s))) for at_s in times_s]
    assert load.waited_s == pytest.approx(TICK_S * sum(told))
    return times_s[told]


def test_a_load_that_comes_on_at_once_waits_until_the_machine_has_swayed():
    """Pressed by 0.6 at once, it sways to 1.2; after half a sway 0.3 of that are past."""
    told_s = too_sudden(lambda at_s: 0.6 * (at_s > 1.0))
    half_s = Sway(M545.model_copy(update={"stance": ON_LEGS.stance})).period_s(
        SIDE, 0.6 * TIPPING_N / 9.81
    )
    assert told_s[0] == pytest.approx(1.05)
    assert told_s[-1] == pytest.approx(1.0 + half_s / 2, abs=2 * TICK_S)


@pytest.mark.parametrize(
    "share_at",
    [
        lambda at_s: 0.4 * min(at_s / 0.5, 1.0),
        lambda at_s: 0.7 * min(at_s / 2.5, 1.0),
        lambda at_s: -2.0 * (at_s > 1.0),
    ],
    ids=["little", "slowly", "upwards"],
)
def test_what_leaves_a_tenth_of_what_holds_the_machine_is_not_too_sudden(share_at):
    assert too_sudden(share_at).size == 0


def test_a_machine_that_does_not_yield_does_not_sway():
    assert too_sudden(lambda at_s: 0.7 * (at_s > 1.0), machine=M545).size == 0


def test_a_load_that_tips_the_machine_at_rest_is_not_waited_for_without_end():
    told_s = too_sudden(lambda at_s: 0.95 * (at_s > 1.0), until_s=20.0)
    assert told_s.size * TICK_S == pytest.approx(2 * SLOWEST_S, abs=0.06)


@pytest.mark.parametrize(("waits", "tips"), [(True, False), (False, True)])
@pytest.mark.parametrize("whole", [0.66, 0.72])
def test_taken_on_in_steps_a_load_does_not_tip_a_machine_that_sways(whole, waits, tips):
    """Jaws bring a whole stone within a third of a second, and stop a tick after they are told.

    The machine sways as a spring of its period with a tenth of the critical damping.
    """
    load, turning = SuddenLoad(SimpleNamespace(machine=lambda: ON_LEGS)), 2 * np.pi / 0.9
    lifted = sways = speed = largest = 0.0
    told, step_s = [False, False], 0.001
    for at_s in np.arange(0.0, 12.0, TICK_S):
        for _ in range(round(TICK_S / step_s)):
            if not (waits and told[-2]):
                lifted = min(lifted + 3 * whole * step_s, whole)
            pull = turning**2 * (lifted - sways) - 0.2 * turning * speed
            speed += pull * step_s
            sways += speed * step_s
            largest = max(largest, sways)
        told.append(load.is_too_sudden(at_s, SIDE, weight(lifted)))
    assert lifted == pytest.approx(whole)
    assert (largest > 1.0) is tips
