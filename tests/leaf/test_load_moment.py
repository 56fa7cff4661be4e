"""A lift ends before what comes to hang in the jaws tips the machine."""

from collections.abc import Callable, Generator
from types import SimpleNamespace
from typing import Any

import pytest

from executive.leaf.load_moment import LoadMoment
from executive.leaf.outcome import Outcome, succeeded
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine, load_machine
from tests.leaf.looked_on import TICK_S, outcome_of

M545 = load_machine("m545")
ON_LEGS = M545.model_copy(update={"stance": M545.stance.model_copy(update={"is_free": True})})
CARRY = M545.posture("carry")
TIPPING_KG = LiftCapacity(M545).at(CARRY).tipping_kg
LIFT_S = 3.0


def lifted(
    hangs_kg: Callable[[float], float | None], machine: Machine = ON_LEGS
) -> tuple[Outcome[None], float, bool]:
    """Return how a lift ended, when, and whether the arm was stopped."""
    context: Any = SimpleNamespace(
        time_s=0.0,
        machine=lambda: machine,
        arm=lambda: CARRY,
        now_s=lambda: context.time_s,
        payload_kg=lambda: hangs_kg(context.time_s),
    )
    return outcome_of(context, LIFT_S, LoadMoment(context).limited)


def test_a_lift_that_is_halted_stops_the_arm() -> None:
    stopped = []

    def moving() -> Generator[None, None, Outcome[None]]:
        try:
            yield None
        finally:
            stopped.append(True)
        return succeeded()

    context: Any = SimpleNamespace(
        machine=lambda: ON_LEGS, now_s=lambda: 0.0, payload_kg=lambda: 0.0
    )
    motion = moving()
    steps = LoadMoment(context).limited(motion)
    next(steps)
    steps.close()
    assert stopped


def test_a_load_that_would_tip_the_machine_stops_the_lift_as_it_comes_on() -> None:
    outcome, ended_s, is_stopped = lifted(lambda time_s: TIPPING_KG * time_s / 2)
    assert not outcome.success
    assert f"{TIPPING_KG:.0f} kg tip the machine here" in outcome.reason
    assert 1.65 < ended_s < 2.0  # at 0.825 of it, and half of the time over which it is weighed
    assert is_stopped


@pytest.mark.parametrize(
    ("hangs_kg", "machine"),
    [
        (lambda time_s: 0.75 * TIPPING_KG, ON_LEGS),
        (lambda time_s: (0.75 + 0.2 * (-1.0) ** int(time_s / 0.25)) * TIPPING_KG, ON_LEGS),
        (lambda time_s: 2.0 * TIPPING_KG, M545),
        (lambda time_s: None, ON_LEGS),
    ],
    ids=["rated", "rated, swaying", "welded", "nobody weighs"],
)
def test_a_rated_load_is_lifted(hangs_kg: Any, machine: Machine) -> None:
    outcome, ended_s, is_stopped = lifted(hangs_kg, machine)
    assert (outcome.success, is_stopped) == (True, False)
    assert ended_s == pytest.approx(LIFT_S, abs=TICK_S)
