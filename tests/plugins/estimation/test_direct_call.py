"""Calls of compiled code without the choice among its variants."""

import numpy as np
import pytest
from executive_plugins.estimation.direct_call import direct
from numba import njit, types

VECTOR = types.Array(types.float64, 1, "A", readonly=True)


@njit(types.float64(VECTOR, types.float64))
def weighed(values, weight):
    return weight * values[0]


@njit([types.float64(types.float64), types.int64(types.int64)])
def twice(value):
    return 2 * value


def test_answers_as_the_compiled_function_does() -> None:
    values = np.array([1.5, 2.0])
    locked = values.view()
    locked.flags.writeable = False
    for given in (values, locked, np.arange(3.0)[::2]):
        assert direct(weighed)(given, 2) == weighed(given, 2)


@pytest.mark.parametrize("wrong", [np.ones(2, np.float32), [1.0], None])
def test_refuses_what_is_no_array_of_such_items(wrong: object) -> None:
    with pytest.raises(TypeError, match="unbox"):
        direct(weighed)(wrong, 2.0)


def test_refuses_a_function_of_several_signatures() -> None:
    with pytest.raises(ValueError, match="unpack"):
        direct(twice)
