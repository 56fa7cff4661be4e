"""Low points belong to the foot of the object that they are near to."""

import numpy as np
import pytest
from executive_plugins.segmentation.feet import feet_of, rows_beside

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


@pytest.mark.parametrize("seed", range(4))
def test_rows_beside_objects_hold_all_points_within_reach_and_leave_out_what_is_far(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    parts = [rng.uniform(-0.5, 0.5, (200, 3)) + middle for middle in rng.uniform(0, 8, (5, 3))]
    points, above = rng.uniform(-1, 9, (20_000, 3)), rng.uniform(-0.1, 0.2, 20_000)
    rows = rows_beside(points, above, (0.03, 0.10), parts, 0.1)
    assert (np.diff(rows) > 0).all()
    assert ((above[rows] > 0.03) & (above[rows] <= 0.10)).all()
    low = (above > 0.03) & (above <= 0.10)
    apart = np.linalg.norm(points[:, None, :2] - np.vstack(parts)[None, :, :2], axis=2).min(1)
    assert set(np.flatnonzero(low & (apart <= 0.1))) <= set(rows)
    assert (apart[rows] < 0.1 * 2 * np.sqrt(2)).all()  # two cells of the reach, cornerwise


def test_no_objects_or_no_reach_have_no_rows_beside() -> None:
    low, above = np.zeros((1, 3)), np.full(1, 0.05)
    assert not len(rows_beside(low, above, (0.03, 0.10), [], 0.1))
    assert not len(rows_beside(low, above, (0.03, 0.10), PARTS, 0.0))
