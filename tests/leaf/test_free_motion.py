"""An arm that carries nothing stops once it presses on something, or lifts something."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from executive.leaf.free_motion import FreeMotion
from executive.leaf.outcome import Outcome
from executive.leaf.own_motion import OwnMotion
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.machine import Machine, load_machine
from executive.machine.tipping_moment import SHARE, TippingMoment
from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory
from tests.leaf.looked_on import TICK_S, outcome_of

M545 = load_machine("m545")
CARRY = M545.posture("carry")
STILL = JointSample(
    0.0, M545.joint_names, np.append(CARRY, 0.0), *np.zeros((2, len(M545.joint_names)))
)
MOTION_S = 3.0
STAY = JointTrajectory(
    M545.arm_names, np.array([0.0, MOTION_S]), np.stack([CARRY, CARRY]), np.zeros((2, len(CARRY)))
)


def force_of(share: float, upwards: bool) -> float:
    """Return the mass whose weight on the tool takes a share of what holds the machine [kg]."""
    moment = TippingMoment(M545)
    sign = 1.0 if upwards else -1.0
    per_n = moment.tipping_nm(CARRY, np.array([0.0, 0.0, sign])) / moment.holding_nm(CARRY, 0.0)
    return float(-sign * share / per_n.max() / GRAVITY_M_S2)


def moved(
    hangs_kg: Callable[[float], float | None],
    machine: Machine = M545,
    way: JointTrajectory = STAY,
) -> tuple[Outcome[None], float, bool]:
    """Return how a motion ended, when, and whether the arm was stopped."""
    context: Any = SimpleNamespace(
        time_s=0.0,
        machine=lambda: machine,
        arm=lambda: CARRY,
        now_s=lambda: context.time_s,
        payload_kg=lambda: hangs_kg(context.time_s),
        use=lambda interface: SimpleNamespace(command=lambda command: None),
        joints=lambda: STILL,
    )
    return outcome_of(context, MOTION_S, FreeMotion(context, way).watched)


@pytest.mark.parametrize(
    ("upwards", "told"),
    [(True, "the arm presses on something"), (False, "something hangs on the jaws")],
)
def test_a_force_that_would_take_half_of_what_holds_the_machine_stops_the_arm(
    upwards: bool, told: str
) -> None:
    too_much = force_of(1.1 * SHARE, upwards)
    assert (too_much < 0) is upwards
    outcome, ended_s, is_stopped = moved(lambda time_s: too_much if time_s >= 1.0 else 0.0)
    assert not outcome.success
    assert outcome.reason.startswith(f"{told}, {abs(too_much):.0f} kg")
    assert ended_s == pytest.approx(1.0 + TICK_S)
    assert is_stopped


@pytest.mark.parametrize("upwards", [True, False])
def test_less_than_that_stops_nothing(upwards: bool) -> None:
    outcome, ended_s, is_stopped = moved(lambda time_s: force_of(0.9 * SHARE, upwards))
    assert outcome.success
    assert ended_s >= MOTION_S
    assert not is_stopped


def test_one_sample_that_errs_stops_nothing() -> None:
    assert moved(lambda time_s: 9000.0 if abs(time_s - 1.0) < TICK_S / 2 else 0.0)[0].success


def test_an_arm_that_presses_at_first_may_leave_but_not_press_more() -> None:
    pressed = force_of(0.9, upwards=True)
    assert moved(lambda time_s: pressed * max(1.0 - time_s, 0.0))[0].success
    outcome, ended_s, _ = moved(lambda time_s: pressed * (1.0 + 0.2 * time_s))
    assert not outcome.success
    assert 0.4 < ended_s < 0.8  # at 1.1 of what it was


def test_without_supports_or_a_monitor_nothing_is_too_much() -> None:
    stance = M545.stance.model_copy(update={"supports_m": ()})
    assert moved(lambda time_s: -9000.0, M545.model_copy(update={"stance": stance}))[0].success
    assert moved(lambda time_s: None)[0].success


def braking(by_rad: float) -> JointTrajectory:
    """Return a motion of the boom that brakes evenly over its last second."""
    times_s = np.linspace(0.0, MOTION_S, 61)
    speed = np.clip(MOTION_S - times_s, 0.0, 1.0) * np.clip(times_s, 0.0, 1.0)
    gone = np.concatenate([[0.0], np.cumsum(speed[1:] * np.diff(times_s))])
    position = np.tile(CARRY, (len(times_s), 1))
    position[:, M545.arm_names.index("J_BOOM")] += by_rad * gone
    velocity = np.gradient(position, times_s, axis=0)
    return JointTrajectory(M545.arm_names, times_s, position, velocity)


def test_an_arm_that_brakes_on_its_way_down_lifts_nothing() -> None:
    """Its own mass pulls at its joints, later and harder than the plan says, on springs."""
    way = braking(-0.6)
    context: Any = SimpleNamespace(machine=lambda: M545, arm=lambda: CARRY, now_s=lambda: 0.0)
    own = OwnMotion(context, way)
    assert own.beyond(600.0, 1.0) == pytest.approx(600.0, abs=100.0)  # at a constant speed
    assert own.beyond(600.0, 2.5) == 0.0  # of a motion that tells 430 kg by itself
    assert own.beyond(-600.0, 2.5) < -500.0  # which pulls it down, and does not press it up
    assert own.beyond(600.0, 3.6) > 500.0  # it has long come to rest


@pytest.mark.parametrize(("share", "is_stopped"), [(0.95, False), (1.3, True)])
def test_what_the_motion_itself_tells_is_no_load(share: float, is_stopped: bool) -> None:
    hangs_kg = force_of(share * SHARE, upwards=False) + 700.0

    def told(time_s: float) -> float:
        return hangs_kg if 2.1 < time_s < 2.6 else 0.0

    assert moved(told)[2]  # of an arm that is at rest
    assert moved(told, way=braking(-0.6))[2] is is_stopped
