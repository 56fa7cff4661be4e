"""The factor of an antenna with an unknown arm and clock, against the motion and differences."""

from collections.abc import Mapping

import gtsam
import numpy as np
import pytest
from executive_plugins.estimation.calibration.unknown_arm_factor import unknown_arm_factor

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy

X, V, A, D = (gtsam.symbol(letter, 0) for letter in "xvld")
SIZES = {X: 6, V: 3, A: 3, D: 1}
P, SPEED = np.array([1.0, 2.0, 3.0]), np.array([2.0, -1.0, 0.5])
ARM, RATE = np.array([0.5, -1.0, 2.0]), np.array([0.2, -0.1, 0.6])
R = from_rpy(0.2, -0.3, 1.0)
LATE_S, STD_M = 0.08, 0.02
# Where the antenna is at the time of measurement, on a straight path with its own velocity.
FIX = P + R @ ARM - LATE_S * (SPEED + R @ np.cross(RATE, ARM))


def values() -> gtsam.Values:
    made = gtsam.Values()
    made.insert(X, gtsam.Pose3(pose(R, P)))
    made.insert(V, SPEED)
    made.insert(A, ARM)
    made.insert(D, np.array([LATE_S]))
    return made


def factor(z: Float) -> gtsam.NonlinearFactor:
    return unknown_arm_factor((X, V, A, D), z, STD_M**2 * np.eye(3), RATE)


def whitened(at: gtsam.Values) -> tuple[Mapping[int, Float], Float]:
    """Return the derivatives by key and the residual, in standard deviations."""
    linear = factor(FIX).linearize(at)
    columns = np.split(linear.getA().copy(), np.cumsum(list(SIZES.values()))[:-1], axis=1)
    return dict(zip(linear.keys(), columns, strict=True)), -linear.getb().copy()


def test_an_antenna_that_is_where_the_motion_says_has_no_error() -> None:
    assert factor(FIX).error(values()) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("key", SIZES)
def test_the_derivatives_are_those_of_the_residual(key: int) -> None:
    at = values()
    at.update(D, np.array([LATE_S + 0.002]))  # within the range where the kernel is quadratic
    slopes, _ = whitened(at)
    step = 1e-6
    for i in range(SIZES[key]):
        residuals = []
        for one in (step, -step):
            delta = gtsam.VectorValues()
            delta.insert(key, one * np.eye(SIZES[key])[i])
            residuals.append(whitened(at.retract(delta))[1])
        after, before = residuals
        assert slopes[key][:, i] == pytest.approx((after - before) / (2 * step), abs=1e-4)


def test_beyond_95_of_100_distances_the_error_grows_linearly() -> None:
    """The square of three standard deviations' distance has the 95 % quantile 7.815."""
    limit = np.sqrt(7.8147279)
    for sigmas, expected in (
        (2.7, 0.5 * 2.7**2),
        (2.9, limit * (2.9 - limit / 2)),
        (20.0, limit * (20.0 - limit / 2)),
    ):
        off = np.array([0.0, 0.6, -0.8]) * sigmas * STD_M
        assert factor(FIX + off).error(values()) == pytest.approx(expected, rel=1e-6)
