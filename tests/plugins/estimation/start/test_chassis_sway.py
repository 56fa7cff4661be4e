"""A chassis that stands: how fast it turns, told from the bias of its gyroscope."""

from copy import deepcopy

import numpy as np
import pytest
from executive_plugins.estimation.start.chassis import StandstillDetector
from executive_plugins.estimation.start.chassis_sway import ChassisSway
from executive_plugins.estimation.start.settings import StandstillSettings

from executive.machine.machine import Machine
from executive.machine.rig import Rig

PIECE_S, NOISE_RAD_S = 0.5, 0.0003  # of the mean of a piece
BIAS = np.array([0.002, -0.0015, 0.001])


@pytest.fixture
def sway(machine: Machine) -> ChassisSway:
    found = ChassisSway.of(machine, "imu_base", StandstillSettings())
    assert found is not None
    return found


def resting(sway: ChassisSway, pieces: int, first: int = 0) -> None:
    """Let a chassis rest for some pieces."""
    rng = np.random.default_rng(first)
    for k in range(first, first + pieces):
        sway.take(k * PIECE_S, BIAS + rng.normal(0, NOISE_RAD_S, 3), PIECE_S)


def test_a_bias_of_the_sheet_is_no_turn_before_anything_is_learnt(sway) -> None:
    assert sway.rate_rad_s(BIAS, PIECE_S) == 0.0
    assert sway.rate_rad_s(BIAS + [0.02, 0, 0], PIECE_S) == pytest.approx(0.02, rel=0.15)


@pytest.mark.parametrize("turn_rad_s", [0.004, 0.02])
def test_a_turn_shows_once_the_bias_is_learnt(sway, turn_rad_s: float) -> None:
    resting(sway, 120)
    assert sway.rate_rad_s(BIAS, PIECE_S) == 0.0
    told = sway.rate_rad_s(BIAS + [0.0, turn_rad_s, 0.0], PIECE_S)
    assert told == pytest.approx(turn_rad_s, rel=0.15)


def test_leans_to_and_fro_are_not_learnt_as_a_bias(sway) -> None:
    resting(sway, 20)
    for k in range(20, 60):
        sway.take(k * PIECE_S, BIAS + [0.025 * (-1) ** (k // 3), 0, 0], PIECE_S)
    assert sway.rate_rad_s(BIAS, PIECE_S) < 0.001


def test_pieces_that_overlap_are_one(sway) -> None:
    often, once = sway, deepcopy(sway)
    for k in range(20):
        often.take(k * PIECE_S / 5, BIAS, PIECE_S)
    for k in range(4):
        once.take(k * PIECE_S, BIAS, PIECE_S)
    turned = BIAS + [0.01, 0.0, 0.0]
    assert often.rate_rad_s(turned, PIECE_S) == once.rate_rad_s(turned, PIECE_S)


def quiet(detector: StandstillDetector, turn_rad_s: float) -> StandstillDetector:
    for k in range(50):
        detector.add(k / 100, BIAS + [turn_rad_s, 0, 0], np.array([0, 0, 9.81]))
    assert detector.is_at_rest(0.49)
    return detector


@pytest.mark.parametrize("turn_rad_s", [0.0, 0.02])
def test_what_is_told_ten_times_a_second_is_one_piece_of_information(sway, turn_rad_s) -> None:
    told_rad_s, told_m_s = quiet(StandstillDetector(StandstillSettings(), sway), turn_rad_s).sway(
        0.1
    )
    assert told_rad_s == pytest.approx(turn_rad_s * 4.9**0.5, rel=0.15)
    assert told_m_s == pytest.approx(1.344 * told_rad_s)  # the cabin's origin above the ground


@pytest.mark.parametrize("name", ["nobody", "gnss_left"])
def test_a_chassis_without_a_sensor_of_its_own_is_taken_to_be_still(name, machine) -> None:
    sway = ChassisSway.of(machine, name, StandstillSettings())
    assert quiet(StandstillDetector(StandstillSettings(), sway), 0.02).sway(0.1) == (0.0, 0.0)


def test_of_a_body_whose_stance_is_not_described_nothing_is_told(machine) -> None:
    body = Rig(name="body", sensors=machine.sensors)
    assert ChassisSway.of(body, "imu_base", StandstillSettings()) is None
