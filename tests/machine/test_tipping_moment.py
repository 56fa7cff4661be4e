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


def lowered(seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a path on which the boom goes down from rest to rest, at the side."""
    u, down = np.linspace(0.0, 1.0, 201), np.zeros(len(M545.joints))
    down[1] = -0.3
    return u * seconds, sideways() + np.outer(u - np.sin(2 * np.pi * u) / (2 * np.pi), down)


def test_braking_twice_as_fast_uses_four_times_of_what_holds() -> None:
    moment = TippingMoment(M545)
    slow, fast = (moment.along(*lowered(s), 1000.0) for s in (4.0, 2.0))
    used = [(one.tipping_nm / one.holding_nm).max() for one in (slow, fast)]
    assert 0.0 < used[0] < 1.0
    assert used[1] == pytest.approx(4 * used[0], rel=0.03)


def test_a_motion_tips_by_the_change_of_its_momentum() -> None:
    """It holds the machine as the arm speeds up downwards, and tips it as it brakes."""
    moment, (times_s, q) = TippingMoment(M545), lowered(2.0)
    dq = np.gradient(q, times_s, axis=0)
    momenta = np.array([moment.momentum(*one, 1000.0) for one in zip(q, dq, strict=True)])
    lost = -np.gradient(momenta, times_s, axis=0)
    found = moment.along(times_s, q, 1000.0)
    at_s = found.step_s * np.arange(len(found.tipping_nm))
    for side in range(lost.shape[1]):
        told = np.interp(at_s, times_s, lost[:, side])
        assert np.abs(found.tipping_nm[:, side] - told).max() < 0.05 * np.abs(told).max()


def test_what_holds_is_that_of_each_posture_and_never_nothing() -> None:
    moment, (times_s, q) = TippingMoment(M545), lowered(2.0)
    borne, beyond = (moment.along(times_s, q, kg).holding_nm for kg in (500.0, 9000.0))
    np.testing.assert_allclose(borne[0], moment.holding_nm(q[0], 500.0))
    tenth = 0.1 * moment.holding_nm(q[0], 0.0)
    assert moment.holding_nm(q[0], 9000.0).min() < 0.0
    np.testing.assert_allclose(beyond[0], np.maximum(moment.holding_nm(q[0], 9000.0), tenth))


def test_a_motion_to_where_the_arm_is_tips_nothing() -> None:
    q = np.tile(sideways(), (2, 1))
    assert not TippingMoment(M545).along(np.array([0.0, 0.1]), q, 500.0).tipping_nm.any()
