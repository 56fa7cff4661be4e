"""Lift capacities: statics of levers, the published shares, and the sentence of a refusal."""

import numpy as np
import pytest

from executive.machine.kinematics import Kinematics
from executive.machine.lift_capacity import Capacity, LiftCapacity
from executive.machine.machine import Machine, load_machine

M545 = LiftCapacity(load_machine("m545"))


def test_the_machine_tips_where_its_weight_balances_the_load() -> None:
    """Over the front axle: the whole machine's weight times its lever equals the load's."""
    machine = load_machine("m545")
    q = machine.posture("carry")
    frames = Kinematics(machine).frames(q)
    masses = {name: link.mass_kg for name, link in machine.links.items()}
    levers = {
        name: 1.65 - (frames[name] @ [*link.com_m, 1.0])[0] for name, link in machine.links.items()
    }
    load_x = (frames["gripper"] @ [*machine.gripper.grasp_centre, 1.0])[0]
    expected = sum(masses[name] * levers[name] for name in masses) / (load_x - 1.65)
    assert M545.at(q).tipping_kg == pytest.approx(expected)


def test_it_carries_less_at_the_side_and_farther_out() -> None:
    front, side = M545.near(6.0, 0.0), M545.near(6.0, np.pi / 2)
    assert front is not None
    assert side is not None
    # By an outside trial on the same masses: 2.7 t forwards and 1.3 t sideways at 6 m.
    assert front.tipping_kg == pytest.approx(2700, rel=0.05)
    assert side.tipping_kg == pytest.approx(1300, rel=0.05)
    near = M545.near(4.5, np.pi / 2)
    assert near is not None
    assert near.rated_kg > side.rated_kg


def test_the_rated_capacity_is_the_least_of_the_three() -> None:
    assert Capacity(5.0, 0.0, 2000.0, 9000.0, 3000.0).rated_kg == pytest.approx(1500.0)
    assert Capacity(5.0, 0.0, 9000.0, 2000.0, 3000.0).rated_kg == pytest.approx(1740.0)
    assert Capacity(5.0, 0.0, 9000.0, 9000.0, 3000.0).rated_kg == 3000.0


def test_a_refusal_says_radius_mass_capacity_and_cause() -> None:
    capacity = Capacity(6.0, np.pi / 2, 1260.0, 9375.0, 3000.0)
    assert capacity.refusal(900.0) == ""
    assert capacity.refusal(1800.0) == (
        "1800 kg at 6.0 m and 90° are beyond the lift capacity of 945 kg "
        "(75 % of 1260 kg that tip the machine, ISO 10567)"
    )


def test_no_capacity_out_of_reach() -> None:
    assert M545.near(12.0, 0.0) is None


def test_a_machine_that_does_not_tell_where_it_stands_has_no_tipping_load() -> None:
    machine: Machine = load_machine("mini")
    stance = machine.stance.model_copy(update={"supports_m": ()})
    free = LiftCapacity(machine.model_copy(update={"stance": stance}))
    capacity = free.at(machine.posture("carry"))
    assert capacity.tipping_kg == np.inf
    assert capacity.rated_kg <= machine.payload_kg


def test_the_capacity_of_a_path_is_the_least_on_it() -> None:
    """From the front over the side to the back, at one radius: the side is the worst."""
    machine = load_machine("m545")
    q = np.tile(machine.posture("carry"), (90, 1))
    q[:, machine.arm_names.index(machine.turn_joint)] = np.linspace(0.0, np.pi, 90)
    least = M545.along(q)
    assert least.rated_kg < min(M545.at(q[0]).rated_kg, M545.at(q[-1]).rated_kg)
    assert least.azimuth_rad == pytest.approx(np.pi / 2, abs=0.3)
