"""Efforts of the arm: of its weights, of a load, and of accelerations."""

import numpy as np
import pytest

from executive.errors import ShapeError
from executive.geometry.pose import transform
from executive.machine.dynamics import Dynamics
from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine

MACHINE = load_machine("m545")
DYNAMICS, KINEMATICS = Dynamics(MACHINE), Kinematics(MACHINE)
Q = MACHINE.posture("carry")
STILL = np.zeros(len(Q))
UP = np.array([0.0, 0.0, 1.0])
TURN = MACHINE.arm_names.index(MACHINE.turn_joint)
STEP = 1e-4


def masses_at(q):
    """Return mass and place of each link in base axes."""
    frames = KINEMATICS.frames(q)
    return [
        (link.mass_kg, transform(frames[name], np.array(link.com_m)))
        for name, link in MACHINE.links.items()
    ]


def load_at(q):
    return transform(KINEMATICS.gripper(q), MACHINE.gripper.grasp_centre)


def slope(height, q):
    """Return the derivative of a function of the posture by each joint."""
    steps = STEP * np.eye(len(q))
    return np.array([(height(q + s) - height(q - s)) / (2 * STEP) for s in steps])


@pytest.mark.parametrize("up", [UP, np.array([0.0, 0.6, 0.8])])
def test_at_rest_efforts_are_the_slope_of_the_potential_energy(up):
    def energy(q):
        return sum(9.81 * kg * float(up @ at) for kg, at in masses_at(q))

    assert DYNAMICS.efforts(Q, STILL, STILL, up, 0.0) == pytest.approx(slope(energy, Q), rel=1e-5)


def test_a_load_adds_its_own_weight():
    empty, loaded = (DYNAMICS.efforts(Q, STILL, STILL, UP, kg) for kg in (0.0, 700.0))
    own = slope(lambda q: 700.0 * 9.81 * float(load_at(q)[2]), Q)
    assert loaded - empty == pytest.approx(own, rel=1e-5, abs=1e-3)
    again = DYNAMICS.efforts(Q, STILL, STILL, UP, 0.0)  # a load is not left in the gripper
    assert np.array_equal(again, empty)


def test_a_swing_accelerates_the_moment_of_inertia():
    faster = np.where(np.arange(len(Q)) == TURN, 0.3, 0.0)
    needs = [DYNAMICS.efforts(Q, STILL, faster, UP, kg)[TURN] for kg in (0.0, 500.0)]
    points = sum(kg * float(at[:2] @ at[:2]) for kg, at in masses_at(Q)[1:])  # the base stands
    assert points < needs[0] / 0.3 < 1.5 * points  # the links' own moments are beside it
    arm_m = float(np.hypot(*load_at(Q)[:2]))
    assert needs[1] - needs[0] == pytest.approx(0.3 * 500.0 * arm_m**2)


def test_an_even_swing_needs_no_effort():
    even = np.where(np.arange(len(Q)) == TURN, 0.5, 0.0)
    assert abs(DYNAMICS.efforts(Q, even, STILL, UP, 800.0)[TURN]) < 1e-6


def test_another_number_of_joints_is_refused():
    with pytest.raises(ShapeError, match=r"q_arm has shape \(3,\), expected \(7,\)"):
        DYNAMICS.efforts(Q[:3], STILL, STILL, UP, 0.0)
