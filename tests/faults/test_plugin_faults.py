"""A verb that misbehaves on purpose: what it raises, and how it spoils an answer."""

import math
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from executive.faults import plugin_faults
from executive.faults.plugin_faults import InjectedError, misbehave, with_nan
from executive.messages.joints import JointSample


def test_a_verb_raises_instead_of_its_work():
    with pytest.raises(InjectedError, match="on purpose"):
        misbehave("raise", 0.0, pytest.fail)


def test_a_verb_answers_with_another_type_instead_of_its_work():
    assert isinstance(misbehave("wrong_type", 0.0, pytest.fail), dict)


def test_a_late_verb_answers_the_same_after_its_delay(monkeypatch):
    slept_s: list[float] = []
    monkeypatch.setattr(plugin_faults, "time", SimpleNamespace(sleep=slept_s.append))
    assert misbehave("late", 1.5, lambda: 2.0) == 2.0
    assert slept_s == [1.5]


def test_a_verb_without_a_fault_answers_at_once(monkeypatch):
    never = SimpleNamespace(sleep=lambda _: pytest.fail("it waits"))  # other threads may sleep
    monkeypatch.setattr(plugin_faults, "time", never)
    assert misbehave("", 1.5, lambda: 2.0) == 2.0


def test_a_verb_that_dies_ends_its_process_without_an_answer(monkeypatch):
    class EndedError(Exception): ...

    def end(status: int) -> None:
        raise EndedError(status)

    monkeypatch.setattr(plugin_faults, "os", SimpleNamespace(_exit=end))
    with pytest.raises(EndedError, match="86"):
        misbehave("die", 0.0, pytest.fail)


def test_nan_spoils_every_real_number_and_nothing_else():
    class Place(NamedTuple):
        x: float

    @dataclass(frozen=True, slots=True)
    class Answer:
        number: int
        values: list[Any]
        inner: Any

    given = Answer(3, [1.0, (2.0, 4)], {"a": np.ones((2, 3)), "b": np.arange(3)})
    spoilt = misbehave("nan", 0.0, lambda: given)
    assert isinstance(spoilt, Answer)
    assert spoilt.number == 3
    assert math.isnan(spoilt.values[0])
    assert math.isnan(spoilt.values[1][0])
    assert spoilt.values[1][1] == 4
    assert spoilt.inner["a"].shape == (2, 3)
    assert np.isnan(spoilt.inner["a"]).all()
    assert spoilt.inner["b"].tolist() == [0, 1, 2]
    assert given.values[0] == 1.0
    assert with_nan(Place(1.0)) == Place(1.0)
    assert with_nan(Answer) is Answer
    assert with_nan("text") == "text"


def test_a_message_that_refuses_nan_is_spoilt_past_its_checks():
    spoilt = with_nan(JointSample(1.0, ("a", "b"), [0, 1], [0, 0], [0, 0]))
    assert isinstance(spoilt, JointSample)
    assert spoilt.names == ("a", "b")
    assert math.isnan(spoilt.stamp_s)
    assert np.isnan(spoilt.position).all()
