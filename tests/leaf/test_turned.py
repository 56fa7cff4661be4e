"""How low a stone may hang that has turned in the jaws."""

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.leaf.turned import lower_by_m
from executive.machine.machine import load_machine

M545 = load_machine("m545")
JAW_RAD = 0.5
# The x axis of the gripper points to the tips, and down here.
DOWN = pose(from_rpy(0.0, np.pi / 2, 0.0), np.array([5.0, 0.0, 1.5]))


@pytest.mark.parametrize(("beside_m", "lower_m"), [(0.2, 0.0), (0.3, 0.0), (0.6, 0.3)])
def test_what_is_farthest_from_the_tips_may_come_to_be_below(beside_m, lower_m) -> None:
    """The stone reaches 0.3 m below the tips, and so far beside them."""
    middle = M545.gripper.tips(JAW_RAD).mean(axis=0)
    surface = middle + np.array([[0.3, 0.0, 0.0], [0.0, beside_m, 0.0]])
    assert lower_by_m(M545, JAW_RAD, surface, DOWN) == pytest.approx(lower_m, abs=1e-9)
