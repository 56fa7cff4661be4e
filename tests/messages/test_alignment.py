"""An alignment as it acts on points."""

import numpy as np

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3
from executive.messages.alignment import Alignment


def test_points_are_scaled_then_turned_then_moved() -> None:
    T = pose(exp_so3(np.array([0.2, 0.4, -0.3])), np.array([1.0, 2.0, 3.0]))
    points = np.random.default_rng(0).normal(0, 3, (20, 3))
    alignment = Alignment(T, True, "", 0.0, 1.0, scale=1.01)
    np.testing.assert_allclose(alignment.apply(points), transform(T, 1.01 * points))
