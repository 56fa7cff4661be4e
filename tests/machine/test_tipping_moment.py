"""The moments about the sides of the area of support: at rest by lift capacity, and in motion."""

import numpy as np
import pytest

from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import load_machine
from executive.machine.tipping_moment import TippingMoment

M545 = load_machine("m545")
TURN = M545.arm_names.index(M545.turn_joint)


def sideways() -> np.ndarray:
    q = M545.posture("carry").copy()
    q[TURN] += np.pi / 2
    return q


def test_what_holds_is_nothing_with_the_load_that_tips_the_machine() -> None:
    q, moment = sideways(), TippingMoment(M545)
    tipping_kg = LiftCapacity(M545).at(q).tipping_kg
    empty = moment.holding_nm(q, 0.0).min()
    assert moment.holding_nm(q, tipping_kg).min() == pytest.approx(0.0, abs=1e-6 * empty)
    assert (
        moment.holding_nm(q, 0.5 * tipping_kg).min()
        > 0.0
        > moment.holding_nm(q, 1.1 * tipping_kg).min()
    )


def test_a_load_presses_on_a_side_by_its_momentum_times_its_lever() -> None:
    """The difference of two loads: down beyond the side, and outwards above the ground."""
    q, moment, kinematics = sideways(), TippingMoment(M545), Kinematics(M545)
    dq = np.array([0.3, -0.2, 0.1, 0.05, 0.0, 0.0, 0.0])
    of_ton = moment.momentum(q, dq, 1000.0) - moment.momentum(q, dq, 0.0)
    at, after = (
        transform(kinematics.gripper(x), M545.gripper.grasp_centre) for x in (q, q + 1e-6 * dq)
    )
    speed, height_m = (after - at) / 1e-6, at[2] + M545.stance.base_height_m
    left = 1000.0 * (height_m * speed[1] - speed[2] * (at[1] - 1.25))
    assert np.abs(of_ton - left).min() == pytest.approx(0.0, abs=0.01 * abs(left))


def descending(seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a path on which the boom goes down and comes to rest evenly, at the side."""
    u, down = np.linspace(0.0, 1.0, 81), np.zeros(len(M545.joints))
    down[1] = -0.3
    share, slope = 2 * u - u**2, 2 - 2 * u
    q = sideways() + np.outer(share, down)
    return u * seconds, q, np.outer(slope, down) / seconds


def test_braking_twice_as_fast_uses_four_times_of_what_holds() -> None:
    moment = TippingMoment(M545)
    slow, fast = (moment.used(*descending(s), 1000.0) for s in (2.0, 1.0))
    assert 0.0 < slow < 1.0
    assert fast == pytest.approx(4 * slow, rel=0.02)


def test_a_path_that_is_beyond_what_holds_at_rest_uses_more_than_all() -> None:
    assert TippingMoment(M545).used(*descending(2.0), 9000.0) == np.inf
