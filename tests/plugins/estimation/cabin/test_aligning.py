"""While the heading is unknown, fixes move the position, unless they are outside the gate."""

import numpy as np
import pytest
from executive_plugins.estimation.cabin.aligning import Aligning
from executive_plugins.estimation.cabin.aligning_witness import AligningWitness
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    Inertial,
    InertialState,
)
from executive_plugins.estimation.live.layout import SAMPLE
from executive_plugins.estimation.live.packing import unpacked
from executive_plugins.estimation.start.found import Found

Z = np.zeros(3)
UP = np.array([0.0, 0.0, 9.81])
NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
ARM = np.array([1.0, 0.5, 2.0])


class Newest:
    """The last state and covariance that the propagator was given, and its samples."""

    def __init__(self) -> None:
        self.samples, self.ring = 0, np.zeros(20, SAMPLE)

    def step(self, stamp_s: float) -> None:
        self.ring[self.samples] = stamp_s, 0.01, Z, UP
        self.samples += 1

    def take(self, row) -> None:
        self.state, self.covariance = unpacked(row)

    anchor = take


def aligned(off_m: np.ndarray | None, gate: float = 60.0, fix_scale: float = 1.0) -> Newest:
    """Return what is reported after a fix that is off, or none; everything is correlated."""
    A = np.random.default_rng(2).normal(0.0, 0.03, (DIMENSION, 2 * DIMENSION))
    P = A @ A.T
    P[ROTATION, ROTATION] += np.diag([0.0, 0.0, 1.5])
    start = InertialState(Inertial(5.0, Z, UP, 0.01), np.eye(3), Z, Z, Z, Z)
    newest = Newest()
    found = Found(start, P, False, ClockOffset(), fix_scale)
    aligning = Aligning(found, NOISE, newest, gate, AligningWitness())
    if off_m is not None:
        aligning.add_fix(Fix(5.005, "left", ARM, ARM + off_m, 0.02**2 * np.eye(3)))
    for k in range(1, 13):
        newest.step(5.0 + k / 100)
        aligning.add_sample(5.0 + k / 100)
    return newest


def test_the_position_follows_a_fix_and_is_more_certain() -> None:
    off = np.array([0.1, -0.05, 0.1])
    newest, before = aligned(off), aligned(off, gate=0.0)
    assert np.linalg.norm(before.state.p_map_imu) < 0.01  # the mean of eight headings
    moved = (newest.state.p_map_imu - before.state.p_map_imu) @ off / (off @ off)
    assert 0.1 < moved < 1.2
    doubted = aligned(off, fix_scale=1e6)
    assert abs(doubted.state.p_map_imu @ off / (off @ off)) < 0.05
    lost = np.diag(before.covariance - newest.covariance)[POSITION]
    assert lost.max() > 0


@pytest.mark.parametrize("gate", [1e-3, 0.0])
def test_a_fix_outside_the_gate_moves_nothing(gate: float) -> None:
    unmoved = aligned(None).state.p_map_imu
    assert aligned(np.ones(3), gate).state.p_map_imu == pytest.approx(unmoved, abs=1e-4)


def test_a_value_that_is_no_number_is_refused() -> None:
    unmoved = aligned(None).state.p_map_imu
    assert aligned(np.full(3, np.nan)).state.p_map_imu == pytest.approx(unmoved, abs=1e-4)
