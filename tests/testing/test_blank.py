"""Records with empty values in all fields that a test does not give."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from executive.arrays import Float
from executive.interfaces.truth import EstimateErrors, Truth
from executive.messages.verdict import Trouble
from executive.testing.blank import blank


@dataclass(frozen=True)
class _Odd:
    trouble: Trouble


@dataclass(frozen=True)
class _Usual:
    at: Float
    pair: tuple[int, str]
    some: bool
    kept: list[int] = field(default_factory=lambda: [7])
    limit: float = 2.5


def test_each_type_of_a_field_has_its_empty_value() -> None:
    made = blank(_Usual, some=True)
    np.testing.assert_array_equal(made.at, np.zeros(3))
    assert (made.pair, made.some) == ((0, ""), True)
    assert (made.kept, made.limit) == ([7], 2.5)  # a default stays


def test_a_record_within_a_record_is_blank_as_well() -> None:
    assert blank(EstimateErrors).error_m.bias == 0.0
    truth = blank(Truth, scenario="wet")
    assert (truth.scenario, truth.stones, truth.grasps) == ("wet", (), None)
    assert not truth.map


def test_a_field_that_does_not_exist_and_one_without_an_empty_value_are_refused() -> None:
    with pytest.raises(TypeError, match="scenery"):
        blank(Truth, scenery="wet")
    with pytest.raises(TypeError, match=r"no empty value for .*Trouble"):
        blank(_Odd)
