"""A fix that the estimate contradicts by more than both covariances explain is refused."""

import numpy as np
import pytest
from scipy.stats import chi2

from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy, skew
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.watch.antenna_check import AntennaCheck

MACHINE = load_machine("m545")
DATUM = np.array([47.4084, 8.5106, 440.0])
ON_CABIN = next(s for s in MACHINE.sensors_of("gnss") if s.link == MACHINE.cabin_link)
NAME = ON_CABIN.name
P_CABIN = ON_CABIN.T_link_sensor[:3, 3]
T_MAP_CABIN = pose(from_rpy(0.05, -0.03, 0.8), np.array([12.0, -7.0, 2.0]))
VELOCITY, RATE = np.array([0.4, -0.2, 0.1]), np.array([0.02, 0.01, 0.3])
GATE_SIGMAS = np.sqrt(chi2.isf(1e-9, 3))


def state(stamp_s=10.0, T=T_MAP_CABIN, covariance=None):
    covariance = 1e-12 * np.eye(6) if covariance is None else covariance
    return BaseState(stamp_s, T, T, T, VELOCITY, RATE, covariance, "GLOBAL")


def at(stamp_s=10.0, off_map=(0.0, 0.0, 0.0), antenna=NAME, std_m=0.01):
    """Return a fix of where the antenna is at a time, and off that."""
    R = T_MAP_CABIN[:3, :3]
    p_map = T_MAP_CABIN[:3, 3] + R @ P_CABIN
    p_map = p_map + (VELOCITY + R @ np.cross(RATE, P_CABIN)) * (stamp_s - 10.0)
    geodetic = geodetic_from_enu(p_map + off_map, DATUM)
    return GnssFix(stamp_s, antenna, geodetic, std_m**2 * np.eye(3), True)


def refusal(fix, *states, datum=DATUM, machine=MACHINE):
    return AntennaCheck(machine, lambda: states, lambda: datum).refusal(fix)


def test_a_fix_where_the_estimate_has_the_antenna_is_taken():
    assert refusal(at(), state()) == ""
    assert refusal(at(10.05), state()) == ""  # by its velocity and its turn
    assert refusal(at(9.95), state()) == ""


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_fix_is_refused_from_the_gate_of_its_covariance_on(axis, sign):
    off = sign * 0.01 * GATE_SIGMAS * np.eye(3)[axis]
    assert refusal(at(off_map=0.98 * off), state()) == ""
    told = refusal(at(off_map=1.02 * off), state())
    assert told == f"{1.02 * 0.01 * GATE_SIGMAS:.2f} m off the estimate"


def test_what_the_estimate_does_not_know_widens_the_gate():
    off = np.array([0.3, 0.0, 0.0])
    assert refusal(at(off_map=off), state()) != ""
    position = np.zeros((6, 6))
    position[3:, 3:] = 0.1**2 * np.eye(3)  # of the position, behind that of the rotation
    assert refusal(at(off_map=off), state(covariance=position)) == ""


def test_an_uncertain_rotation_widens_it_across_the_lever_alone():
    """A turn moves the antenna across its lever arm, and not along it."""
    spread = np.zeros((6, 6))
    spread[:3, :3] = 0.2**2 * np.eye(3)
    along = T_MAP_CABIN[:3, :3] @ P_CABIN / np.linalg.norm(P_CABIN)
    across = np.cross(along, [0.3, 0.8, 0.5])
    across /= np.linalg.norm(across)
    gate_m = GATE_SIGMAS * np.sqrt(0.01**2 + (0.2 * np.linalg.norm(P_CABIN)) ** 2)
    assert refusal(at(off_map=0.98 * gate_m * across), state(covariance=spread)) == ""
    assert refusal(at(off_map=1.02 * gate_m * across), state(covariance=spread)) != ""
    assert refusal(at(off_map=0.1 * along), state(covariance=spread)) != ""
    assert skew(P_CABIN) @ P_CABIN == pytest.approx(0.0)


def test_the_state_nearest_in_time_is_compared():
    period_s = 1 / ON_CABIN.rate_hz
    far = pose(t=np.array([50.0, 0.0, 0.0]))
    before, behind = state(10.0 - period_s, far), state(10.0 + period_s, far)
    for share in (-0.4, 0.0, 0.4):
        assert refusal(at(10.0 + share * period_s), before, state(), behind) == ""
    for share in (-0.6, 0.6, 1.5):
        assert refusal(at(10.0 + share * period_s), before, state(), behind) != ""


def test_a_fix_beyond_two_periods_of_the_estimate_is_not_compared():
    period_s = 1 / ON_CABIN.rate_hz
    off = np.array([5.0, 0.0, 0.0])
    assert refusal(at(10.0 + 1.99 * period_s, off), state()) != ""
    assert refusal(at(10.0 + 2.01 * period_s, off), state()) == ""
    assert refusal(at(10.0 - 2.01 * period_s, off), state()) == ""


def test_without_anything_to_compare_with_no_fix_is_refused():
    off = at(off_map=(5.0, 0.0, 0.0))
    assert refusal(off) == ""
    assert refusal(off, state(), datum=None) == ""
    assert refusal(at(off_map=(5.0, 0.0, 0.0), antenna="gnss_of_nobody"), state()) == ""
    elsewhere = ON_CABIN.model_copy(update={"link": MACHINE.base_link})
    sensors = {**MACHINE.sensors, NAME: elsewhere}
    assert refusal(off, state(), machine=MACHINE.model_copy(update={"sensors": sensors})) == ""
