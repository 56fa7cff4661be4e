"""Motions of a stone in the jaws that a look at it begins from, when it is not as expected."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis

# An alignment finds a stone from within some 15° and a fifth of its size: starts are twice as far
# apart. The jaws open into the stone for less than half of its height before they lose it.
STEP_RAD, _MOST_RAD = np.radians(25.0), np.radians(100.0)
_SLIDES = (0.0, 0.2, 0.4)
_CLOSING = np.array([0.0, 1.0, 0.0])  # of the gripper's frame: from jaw to jaw


def held_starts(tips: Float, surface: Float, down: Float) -> Sequence[Float]:
    """Return motions of a held stone, in the gripper's frame, (4, 4) each; the nearest first.

    Two tips hold a stone like a hinge: one that slips turns about the line through them, and
    slides downwards. Nothing else is free while both jaws bear.

    Args:
        tips: The two tips at the present angle of the jaws [m], shape (2, 3).
        surface: The stone's surface where it is expected [m], shape (N, 3).
        down: Direction of gravity in the gripper's frame, unit vector, shape (3,).
    """
    hinge = np.mean(tips, axis=0)
    height_m = float(np.ptp(surface @ down))
    steps = round(_MOST_RAD / STEP_RAD)
    turns = STEP_RAD * np.arange(-steps, steps + 1)
    both = sorted(product(turns, _SLIDES), key=lambda one: abs(one[0]) / STEP_RAD + 5 * one[1])
    starts = []
    for turn, slide in both[1:]:  # the first is where it is expected
        R = about_axis(_CLOSING, turn)
        starts.append(pose(R, hinge - R @ hinge + slide * height_m * down))
    return starts
