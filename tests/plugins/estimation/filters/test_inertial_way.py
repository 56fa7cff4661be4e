"""A filter of some time ago, predicted by inertial samples without the fixes since."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.filters.inertial_way import InertialWay, KeptFilter
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.live.layout import SAMPLE

PERIOD_S, KEPT_S = 0.01, 1.0
VELOCITY_STD_M_S = 0.1
FORCE = np.array([0.5, 0.0, 9.81])  # it accelerates by 0.5 m/s² along x
LENGTH = 256  # of the memory of samples


def kept(at_s: float, samples: int) -> KeptFilter:
    """Return a filter at the map's origin, with 1 m/s along x."""
    Z, v = np.zeros(3), np.array([1.0, 0.0, 0.0])
    state = InertialState(Inertial(at_s, Z, FORCE, PERIOD_S), np.eye(3), Z, v, Z, Z)
    variances = np.repeat([1e-4, VELOCITY_STD_M_S, 1e-3, 1e-5, 1e-4], 3) ** 2
    noise = InertialNoise(1e-4, 1e-3, 1e-5, 1e-4, 0.1, 9.81, PERIOD_S)
    return KeptFilter(ErrorStateFilter(state, np.diag(variances), noise).block.copy(), samples)


def sampled(count: int) -> SimpleNamespace:
    """Return a memory that so many samples have been written to."""
    ring = np.zeros(LENGTH, SAMPLE)
    for k in range(count):
        ring[k % LENGTH] = (round((k + 1) * PERIOD_S, 6), PERIOD_S, np.zeros(3), FORCE)
    return SimpleNamespace(ring=ring, samples=count)


def test_samples_take_a_filter_on() -> None:
    """1 s of 1 m/s and 0.5 m/s², with the error of the velocity."""
    way = InertialWay(sampled(200), KEPT_S)
    way.add(kept(0.5, 50))
    position, covariance = way.end(0.5, 1.5)
    assert position == pytest.approx([1.25, 0.0, 0.0], abs=1e-3)
    assert np.sqrt(covariance[1, 1]) == pytest.approx(VELOCITY_STD_M_S, rel=0.02)


def test_a_filter_that_was_not_kept_is_not_taken_on() -> None:
    way = InertialWay(sampled(200), KEPT_S)
    way.add(kept(0.5, 50))
    assert way.end(0.7, 1.5) is None


def test_a_filter_is_forgotten_once_a_newer_one_is_old_enough() -> None:
    way = InertialWay(sampled(200), KEPT_S)
    for at_s in (0.3, 0.5, 1.5):
        way.add(kept(at_s, round(at_s / PERIOD_S)))
    assert way.end(0.3, 1.5) is None
    assert way.end(0.5, 1.5) is not None


def test_samples_that_were_written_over_take_no_filter_on() -> None:
    samples = sampled(50 + LENGTH)
    way = InertialWay(samples, KEPT_S)
    way.add(kept(0.5, 50))
    assert way.end(0.5, 1.5) is not None
    samples.samples += 1
    assert way.end(0.5, 1.5) is None
