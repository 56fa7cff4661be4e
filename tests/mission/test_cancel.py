"""A cancelled leaf keeps what it drove until that stands; past the deadline the machine stops."""

import numpy as np
import pytest

from executive.clock import SimulatedClock
from executive.events.mission import PartsReleased
from executive.leaf.claims import Part, joints_of
from executive.leaf.rest import stop_limit_s
from executive.machine.machine import load_machine
from executive.messages.joints import JointSample
from executive.mission.braking import Braking, MachineMovesError

MACHINE = load_machine("m545")
TICK_S = 0.05


def sample(stamp_s, speed, joint=MACHINE.turn_joint):
    names = MACHINE.joint_names
    velocity = np.array([speed if name == joint else 0.0 for name in names])
    return JointSample(stamp_s, names, velocity * stamp_s, velocity, np.zeros(len(names)))


@pytest.fixture
def told():
    return []


@pytest.fixture
def braking(told):
    return Braking(SimulatedClock(), MACHINE, lambda node, event: told.append((node, event)))


def let_time_pass(braking, seconds, speed, joint=MACHINE.turn_joint):
    for _ in range(round(seconds / TICK_S)):
        braking._clock.advance(TICK_S)
        braking.update(sample(braking._clock.machine_s(), speed, joint))


def test_what_moves_is_kept_until_it_stands(braking, told):
    braking.add("main/0", (Part.ARM, Part.CABIN), sample(0.0, 0.3))
    assert "main/0 was cancelled" in braking.awaited((Part.CABIN,))
    assert braking.awaited((Part.JAWS,)) == ""
    let_time_pass(braking, 1.0, 0.3)
    assert braking.awaited((Part.MACHINE,))
    let_time_pass(braking, TICK_S, 0.0)
    assert braking.awaited((Part.MACHINE,)) == ""
    [(node, event)] = told
    assert node == "main/0"
    assert isinstance(event, PartsReleased)
    assert event.after_s == pytest.approx(1.05)


def test_what_stands_is_free_at_once(braking, told):
    braking.add("main/0", (Part.ARM, Part.CABIN), sample(0.0, 0.0))
    assert braking.awaited((Part.MACHINE,)) == ""
    assert told == []


def test_past_the_deadline_the_error_names_the_leaf_and_the_limit(braking):
    braking.add("main/0", (Part.CABIN,), sample(0.0, 0.3))
    limit_s = stop_limit_s(MACHINE, [MACHINE.turn_joint])
    let_time_pass(braking, limit_s - 2 * TICK_S, 0.3)
    with pytest.raises(MachineMovesError, match=r"cabin still move .* after main/0 was cancelled"):
        let_time_pass(braking, 4 * TICK_S, 0.3)


def test_the_deadline_follows_from_the_limits_of_the_machine():
    # The turning joint has 0.8 rad/s and 0.4 rad/s²: two seconds to come to rest.
    assert MACHINE.stop_s([MACHINE.turn_joint]) == pytest.approx(2.0)
    assert stop_limit_s(MACHINE, [MACHINE.turn_joint]) == pytest.approx(5.0)
    assert MACHINE.stop_s([]) == 0.0


@pytest.mark.parametrize(
    ("parts", "joints"),
    [
        ((Part.JAWS,), ()),
        ((Part.JAWS, Part.LIDARS), ()),
        ((Part.CABIN,), (MACHINE.turn_joint,)),
        ((Part.ARM,), MACHINE.arm_names[1:]),
        ((Part.ARM, Part.CABIN), MACHINE.arm_names),
        ((Part.MACHINE,), MACHINE.arm_names),
        (("second arm",), MACHINE.arm_names),
    ],
)
def test_the_joints_of_parts(parts, joints):
    assert joints_of(parts, MACHINE) == joints
