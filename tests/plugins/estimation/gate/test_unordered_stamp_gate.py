"""Stamps of streams that may come late: each once, and none from the future."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.stamp_gate import StampGate
from executive_plugins.estimation.gate.unordered_stamp_gate import UnorderedStampGate


@pytest.fixture
def gates() -> tuple[StampGate, UnorderedStampGate]:
    counts = StampGate()
    return counts, UnorderedStampGate(counts)


def test_late_stamps_are_taken_once(gates: tuple[StampGate, UnorderedStampGate]) -> None:
    counts, gate = gates
    given = [5.0, 4.0, 4.5, 4.0, 5.0, 3.0]
    assert [gate.admits("left", s, 5.0) for s in given] == [True, True, True, False, False, True]
    assert gate.admits("right", 4.0, 5.0)  # another stream has stamps of its own
    assert counts.refused == {"left: duplicate": 2}


@pytest.mark.parametrize(("ahead_s", "is_taken"), [(1.0, True), (1.25, False)])
def test_a_stamp_may_be_a_second_ahead_of_the_inertial_samples(
    gates: tuple[StampGate, UnorderedStampGate], ahead_s: float, is_taken: bool
) -> None:
    counts, gate = gates
    assert gate.admits("left", 5.0 + ahead_s, 5.0) is is_taken
    assert counts.refused == ({} if is_taken else {"left: ahead of time": 1})
    assert gate.admits("left", 5.0 + ahead_s, 6.0) is not is_taken  # its time has come, once


@pytest.mark.parametrize("stamp_s", [np.nan, np.inf, -np.inf])
def test_a_stamp_that_is_no_time_is_refused(
    gates: tuple[StampGate, UnorderedStampGate], stamp_s: float
) -> None:
    counts, gate = gates
    assert not gate.admits("left", stamp_s, np.inf)
    assert counts.refused == {"left: stamp not finite": 1}


def test_the_last_thousand_stamps_are_remembered(
    gates: tuple[StampGate, UnorderedStampGate],
) -> None:
    _, gate = gates
    for k in range(1000):
        assert gate.admits("left", float(k), 1e6)
    assert not gate.admits("left", 0.0, 1e6)
    assert gate.admits("left", 1000.0, 1e6)
    assert gate.admits("left", 0.0, 1e6)
