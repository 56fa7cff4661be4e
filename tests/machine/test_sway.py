"""The sway of a machine on supports that push and never pull, and how far a load makes it sink."""

import numpy as np
import pytest
from scipy.optimize import minimize

from executive.geometry.pose import transform
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.stance import SLOWEST_S
from executive.machine.sway import Sway
from tests.machine.yielding_machine import M545, STIFFNESS_N_M, turned, yielding


def test_a_machine_of_unknown_stiffness_neither_sways_nor_sinks() -> None:
    sway = Sway(yielding(None))
    assert sway.period_s(turned(0.5), 2000.0) == sway.sink_m(turned(0.5), 2000.0) == 0.0


def least_energy_m(q: np.ndarray, load_kg: float) -> float:
    """Return how far the gripper is down where springs that only push bear the machine."""
    frames = Kinematics(M545).frames(q)
    bodies = [(link.mass_kg, frames[n], link.com_m) for n, link in M545.links.items()]
    bodies.append((load_kg, frames["gripper"], M545.gripper.grasp_centre))
    places = np.array([transform(T, np.array(at))[:2] for _, T, at in bodies])
    weights_n = GRAVITY_M_S2 * np.array([mass for mass, _, _ in bodies])

    def up_m(x: np.ndarray, at: np.ndarray) -> np.ndarray:
        return np.asarray(x[0] + at[:, 1] * x[1] - at[:, 0] * x[2])

    def energy(x: np.ndarray) -> float:
        pressed = np.maximum(-up_m(x, np.array(M545.stance.supports_m)), 0.0)
        return float(STIFFNESS_N_M / 2 * (pressed**2).sum() + weights_n @ up_m(x, places))

    x = minimize(
        energy,
        np.zeros(3),
        method="Nelder-Mead",
        options={"maxiter": 4000, "xatol": 1e-9, "fatol": 1e-9},
    ).x
    return -float(up_m(x, places[-1:])[0])


@pytest.mark.parametrize(("angle_rad", "load_kg"), [(0.0, 1000.0), (1.57, 1200.0), (3.0, 800.0)])
def test_it_sinks_to_where_its_springs_have_the_least_energy(
    angle_rad: float, load_kg: float
) -> None:
    q = turned(angle_rad)
    sunk_m = least_energy_m(q, load_kg) - least_energy_m(q, 0.0)
    assert Sway(yielding(STIFFNESS_N_M)).sink_m(q, load_kg) == pytest.approx(sunk_m, rel=0.02)


def test_a_stiffer_machine_sways_faster_by_the_root_but_for_its_arm() -> None:
    q, arm_s = turned(0.3), Sway(yielding(1e12)).period_s(turned(0.3), 1000.0)
    soft_s, hard_s = (
        Sway(yielding(share * STIFFNESS_N_M)).period_s(q, 1000.0) for share in (1.0, 4.0)
    )
    assert soft_s**2 - arm_s**2 == pytest.approx(4 * (hard_s**2 - arm_s**2), rel=1e-4)


def test_a_load_above_a_corner_lifts_the_support_across_and_sways_more_slowly() -> None:
    """By half as much again at once; a load above a side only by its mass."""
    sway = Sway(yielding(STIFFNESS_N_M))
    corner, side = turned(np.arctan2(1.25, 1.65)), turned(np.pi / 2)
    above = [[sway.period_s(q, mass_kg) for mass_kg in (200.0, 2500.0)] for q in (corner, side)]
    assert above[0][1] > 1.4 * above[0][0]
    assert 1.1 * above[1][0] < above[1][1] < 1.35 * above[1][0]


def test_a_load_that_tips_the_machine_has_the_slowest_sway() -> None:
    assert Sway(yielding(STIFFNESS_N_M)).period_s(turned(1.57), 20000.0) == SLOWEST_S
