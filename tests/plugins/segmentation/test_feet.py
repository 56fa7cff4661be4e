"""Low points belong to the foot of the object that they are near to."""

import numpy as np
from executive_plugins.segmentation.feet import feet_of

UPPER = np.array([[0.0, 0.0, 0.12], [0.0, 0.0, 0.6]])
PARTS = [UPPER, UPPER + [0.15, 0.0, 0.0]]


def test_a_low_point_is_of_the_nearest_object() -> None:
    low = np.array([[0.02, 0.0, 0.08], [0.13, 0.0, 0.05], [0.6, 0.0, 0.05]])
    feet = feet_of(PARTS, low, 0.1)
    np.testing.assert_array_equal(feet[0], low[:1])
    np.testing.assert_array_equal(feet[1], low[1:2])  # and the third one is of none


def test_the_upper_part_of_an_object_has_no_foot() -> None:
    leaning = UPPER + [0.0, 0.0, 0.5]
    (foot,) = feet_of([leaning], np.array([[0.0, 0.0, 0.05]]), 0.1)
    assert not len(foot)


def test_without_low_points_or_objects_or_reach_there_are_no_feet() -> None:
    low = np.array([[0.02, 0.0, 0.08]])
    assert [len(foot) for foot in feet_of(PARTS, low[:0], 0.1)] == [0, 0]
    assert [len(foot) for foot in feet_of(PARTS, low, 0.0)] == [0, 0]
    assert feet_of([], low, 0.1) == []
