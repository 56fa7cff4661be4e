"""A machine on supports that yield leans until they bear the weights of its links."""

import numpy as np
import pytest

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.lean import Lean
from tests.machine.yielding_machine import M545, STIFFNESS_N_M, turned, yielding


def test_a_machine_of_unknown_stiffness_leans_nowhere() -> None:
    T_map_base = pose(from_rpy(0.01, 0.02, 0.3), np.array([1.0, 2.0, 0.9]))
    moved = Lean(yielding(None)).moved(T_map_base, turned(0.0), turned(1.5))
    np.testing.assert_array_equal(moved, T_map_base)


@pytest.mark.parametrize("load_kg", [0.0, 2000.0])
@pytest.mark.parametrize("angle_rad", [0.0, 0.8, 1.6, 3.0])
def test_the_supports_bear_the_weight_and_its_moments(angle_rad: float, load_kg: float) -> None:
    """From the way of each support; nothing leans on supports that hardly yield."""
    q, stiff = turned(angle_rad), Lean(yielding(1e15))
    T = Lean(yielding(STIFFNESS_N_M)).moved(np.eye(4), q, q)
    np.testing.assert_allclose(T, np.eye(4), atol=1e-12)
    leant = Lean(yielding(STIFFNESS_N_M))._leant(q, load_kg)
    feet = np.array([[x, y, -M545.stance.base_height_m] for x, y in M545.stance.supports_m])
    forces_n = -STIFFNESS_N_M * (transform(leant, feet) - feet)[:, 2]
    frames = Kinematics(M545).frames(q)
    masses = {name: link.mass_kg for name, link in M545.links.items()}
    places = [transform(frames[n], np.array(link.com_m))[:2] for n, link in M545.links.items()]
    places.append(transform(frames["gripper"], M545.gripper.grasp_centre)[:2])
    weights_n = np.array([*masses.values(), load_kg]) * GRAVITY_M_S2
    assert forces_n.sum() == pytest.approx(weights_n.sum(), rel=1e-3)
    np.testing.assert_allclose(forces_n @ feet[:, :2], weights_n @ places, rtol=0.01, atol=100.0)
    np.testing.assert_allclose(stiff._leant(q, load_kg), np.eye(4), atol=1e-6)


def test_the_way_back_leads_to_where_it_was() -> None:
    lean = Lean(yielding(STIFFNESS_N_M))
    T_map_base = pose(from_rpy(0.01, 0.02, 0.3), np.array([1.0, 2.0, 0.9]))
    there = lean.moved(T_map_base, turned(0.0), turned(2.0))
    assert np.abs(there - T_map_base).max() > 1e-3
    np.testing.assert_allclose(lean.moved(there, turned(2.0), turned(0.0)), T_map_base, atol=1e-12)


def test_a_load_tilts_the_machine_with_the_arm_further_to_the_side_than_to_the_front() -> None:
    """By what hangs in the jaws alone; a load that is turned with the arm is nothing new to it."""
    lean = Lean(yielding(STIFFNESS_N_M))

    def tilts_rad(load_kg: float) -> float:
        T = lean.moved(np.eye(4), turned(0.0), turned(np.pi / 2), load_kg)
        return float(np.arccos(T[2, 2]))

    assert tilts_rad(2000.0) > tilts_rad(0.0) + 2e-3
    same = lean.moved(np.eye(4), turned(0.7), turned(0.7), 2000.0)
    np.testing.assert_allclose(same, np.eye(4), atol=1e-12)
