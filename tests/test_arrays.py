"""The border of arrays: what is let in, and that it cannot be changed afterwards."""

import numpy as np
import pytest

from executive.arrays import checked
from executive.errors import ShapeError


def test_an_array_of_the_wanted_shape_is_kept_not_copied() -> None:
    values = np.zeros((5, 3))
    assert np.shares_memory(checked("points", values, None, 3), values)


def test_what_came_in_is_read_only_on_the_inside() -> None:
    array = checked("points", np.zeros((5, 3)), None, 3)
    with pytest.raises(ValueError, match="read-only"):
        array[0, 0] = 1.0


def test_lists_and_integers_become_floats() -> None:
    array = checked("centre", [1, 2, 3], 3)
    assert array.dtype == np.float64


@pytest.mark.parametrize("values", [np.zeros(3), np.zeros((3, 5)), np.zeros((5, 3, 1)), 1.0])
def test_another_shape_is_refused_with_what_was_wanted(values: object) -> None:
    with pytest.raises(ShapeError, match=r"points has shape .*, expected \(N, 3\)"):
        checked("points", values, None, 3)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_values_that_are_not_finite_are_refused_and_counted(bad: float) -> None:
    values = np.zeros((4, 3))
    values[1:3, 0] = bad
    with pytest.raises(ShapeError, match="points holds 2 values that are not finite"):
        checked("points", values, None, 3)


def test_other_types_may_be_asked_for() -> None:
    assert checked("mask", [True, False], None, dtype=np.bool_).dtype == np.bool_
