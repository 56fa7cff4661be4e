"""All short sequences of stamps, on a grid that meets every limit exactly."""

import itertools
import math

from executive_plugins.estimation.gate.stamp_gate import StampGate
from executive_plugins.estimation.gate.unordered_stamp_gate import UnorderedStampGate

STEPS_S = (-8.0, -0.5, 0.0, 0.5, 1.0, 5.0, 5.5, math.nan)


def test_sequences(recorded) -> None:
    told = []
    for steps in itertools.product(STEPS_S, repeat=4):
        gate, stamp_s = StampGate(), 0.0
        admitted = [gate.admits("a", stamp_s)]
        for step_s in steps:
            admitted.append(gate.admits("a", stamp_s + step_s))
            stamp_s += step_s if math.isfinite(step_s) else 0.0
        told.append((admitted, sorted(gate.refused.items())))
    recorded(told)


def test_a_set_back_clock(recorded) -> None:
    """Behind by some seconds, in steps that add up to the second after which it is followed."""
    told = []
    for behind_s, step_s, jump_s in itertools.product(
        (3.0, 9.0), (0.25, 0.5, 2.0, 3.0), (2.0, 5.0)
    ):
        gate = StampGate()
        stamps = [100.0, 100.5, *(100.5 - behind_s + k * step_s for k in range(6)), 100.75, 101.0]
        told.append(([gate.admits("a", s, jump_s) for s in stamps], dict(gate.refused)))
    recorded(told)


def test_streams_are_apart(recorded) -> None:
    gate = StampGate()
    told = [gate.admits(s, t) for t in (1.0, 1.0, 7.0, 7.5) for s in ("a", "b")]
    gate.refuse("a", "too uncertain")
    recorded((told, gate.refused))


def test_late_stamps(recorded) -> None:
    counts = StampGate()
    gate = UnorderedStampGate(counts)
    stamps = (0.0, 5.0, 6.0, 6.5, 4.0, 5.0, math.nan, math.inf)
    told = [gate.admits(s, t, 5.0) for s in ("a", "b") for t in stamps]
    recorded((told, counts.refused))


def test_stamps_are_remembered_for_a_thousand(recorded) -> None:
    counts = StampGate()
    gate = UnorderedStampGate(counts)
    for k in range(1000):
        gate.admits("a", float(k), 1e6)
    again = [gate.admits("a", t, 1e6) for t in (0.0, 1000.0, 0.0, 0.0, 3.0)]
    recorded((again, counts.refused))
