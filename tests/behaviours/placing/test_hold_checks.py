"""DetectSlip, IsHolding, IsHanging and HasArrived, ticked to success and to failure."""

import pytest

from executive.behaviours.detect_slip import DetectSlip
from executive.behaviours.has_arrived import HasArrived
from executive.behaviours.is_hanging import IsHanging
from executive.behaviours.is_holding import IsHolding
from executive.events.stone import ArrivedEarly
from executive.messages.verdict import Trouble, Verdict
from executive.messages.weight import Weight
from tests.behaviours.placing.scene import DROP, SLIP, SLOTS, placement

EMPTY = Verdict(4.0, "jaw_slip", Trouble.EMPTY, "jaws 0.02 m open")
SLIPPED = ", after a slip: jaws 0.5 m open, 0.6 m before"


def test_no_slip_is_success_and_the_first_verdict_is_told(world):
    assert world.tick(DetectSlip).status == "SUCCESS"
    world.leaf_context.troubles = [SLIP, DROP]
    ended = world.tick(DetectSlip)
    assert ended.status == "FAILURE"
    assert ended.reason == "slip reported by jaw_slip: jaws 0.5 m open, 0.6 m before"


@pytest.mark.parametrize(
    ("troubles", "jaw_rad", "status"),
    [
        ([], 0.6, "SUCCESS"),
        ([SLIP], 0.6, "SUCCESS"),
        ([SLIP, DROP], 0.6, "FAILURE"),
        ([DROP], 0.6, "FAILURE"),
        ([EMPTY], 0.6, "FAILURE"),
        ([], 0.01, "FAILURE"),
        ([SLIP], 0.01, "FAILURE"),
    ],
)
def test_a_stone_is_held_while_the_jaws_are_apart_and_none_has_fallen(
    world, troubles, jaw_rad, status
):
    world.leaf_context.troubles, world.leaf_context.jaw = troubles, lambda t: jaw_rad
    ended = world.tick(IsHolding)
    assert ended.status == status
    fallen = "the stone was dropped" if jaw_rad > 0.5 else "the jaws are closed to 0.01 rad"
    assert ended.reason == ("" if status == "SUCCESS" else fallen)


def test_closed_jaws_hold_what_was_weighed_in_them(world):
    context = world.leaf_context
    context.jaw, context.trial = lambda t: 0.0, Weight(500.0, 40.0)
    assert world.tick(IsHolding).status == "SUCCESS"
    context.troubles = [DROP]
    assert world.tick(IsHolding).reason == "the stone was dropped"


@pytest.mark.parametrize(
    ("standing", "status", "reason"),
    [
        (0.5, "SUCCESS", ""),
        (None, "SUCCESS", "no monitor tells whether the ground carries the stone"),
        (0.98, "FAILURE", "the ground carries the stone (p = 0.98)"),
    ],
)
def test_a_stone_hangs_until_a_monitor_tells_that_it_stands(world, standing, status, reason):
    world.leaf_context.on_ground = standing
    ended = world.tick(IsHanging)
    assert (ended.status, ended.reason) == (status, reason)


def test_a_stone_that_met_the_ground_early_has_arrived(world):
    T = world.leaf_context.gripper()
    T[:3, 3] -= [0.05, 0.0, 0.2]
    world.leaf_context.troubles = [SLIP]
    ended = world.tick(HasArrived, placement=placement(SLOTS[0], T))
    assert ended.status == "SUCCESS"
    (event,) = ended.events
    assert isinstance(event, ArrivedEarly)
    assert (event.aside_m, event.above_m) == (pytest.approx(0.05), pytest.approx(0.2))


@pytest.mark.parametrize(
    ("offset_m", "troubles", "reason"),
    [
        ((0.0, 0.2, 0.0), [SLIP], f"0.00 m above and 0.20 m beside the placement{SLIPPED}"),
        ((0.0, 0.0, 0.4), [SLIP], f"0.40 m above and 0.00 m beside the placement{SLIPPED}"),
        ((0.0, 0.0, 0.0), [SLIP, DROP], "the stone was dropped: 12 kg left of 900 kg"),
    ],
)
def test_a_stone_that_is_elsewhere_or_fell_has_not_arrived(world, offset_m, troubles, reason):
    T = world.leaf_context.gripper()
    T[:3, 3] -= offset_m
    world.leaf_context.troubles = troubles
    ended = world.tick(HasArrived, placement=placement(SLOTS[0], T))
    assert (ended.status, ended.reason, ended.events) == ("FAILURE", reason, [])
