"""What a machine on its legs may carry through a posture."""

import numpy as np
import pytest
from executive_plugins.motion.carried_load import CarriedLoad
from executive_plugins.motion.inverse_kinematics import InverseKinematics
from executive_plugins.motion.settings import InverseKinematicsSettings

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.machine.kinematics import Kinematics
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import load_machine

M545 = load_machine("m545")
CAPACITY = LiftCapacity(M545)


def _beside() -> Float:
    """Return a posture that reaches 1.5 m further than that for carrying, to the left."""
    carry = M545.posture("carry")
    kinematics = Kinematics(M545)
    T = pose(t=np.array([1.5, 0.0, 0.5])) @ kinematics.gripper(carry)
    q = InverseKinematics(InverseKinematicsSettings(), M545, kinematics).solve(T, carry)
    assert q is not None
    q[M545.arm_names.index(M545.turn_joint)] += np.pi / 2
    return q


@pytest.mark.parametrize("share", [0.9, 0.95, 1.0])
def test_a_stone_of_the_payload_may_pass_where_only_the_payload_limits(share: float) -> None:
    q = M545.posture("carry")
    assert CAPACITY.at(q).rated_kg == M545.payload_kg
    assert CarriedLoad(CAPACITY, share * M545.payload_kg).may_pass(q)


def test_elsewhere_it_needs_a_twentieth_more_than_it_weighs() -> None:
    q = _beside()
    rated_kg = CAPACITY.at(q).rated_kg
    assert rated_kg < 0.9 * M545.payload_kg
    assert CarriedLoad(CAPACITY, rated_kg / 1.06).may_pass(q)
    assert not CarriedLoad(CAPACITY, rated_kg / 1.04).may_pass(q)


def test_a_stone_beyond_the_payload_may_pass_nowhere_the_machine_may_not_lift_it() -> None:
    assert not CarriedLoad(CAPACITY, 1.2 * M545.payload_kg).may_pass(_beside())


@pytest.mark.parametrize(("spare_kg", "is_hopeless"), [(-199.0, False), (-201.0, True)])
def test_a_tenth_too_little_is_hopeless(spare_kg: float, is_hopeless: bool) -> None:
    assert CarriedLoad(CAPACITY, 2000.0).is_hopeless(spare_kg) == is_hopeless
