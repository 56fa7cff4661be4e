"""Times without satellite fixes are found by the usual interval between two fixes."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.estimate.drop import Drop
from executive.estimate.silence import silences
from executive.messages.gnss import GnssFix


def material(stamps_s, *drops):
    fixes = [GnssFix(stamp_s, "top", np.zeros(3), np.eye(3), True) for stamp_s in stamps_s]
    arrivals = [SimpleNamespace(observation=one) for one in ("another observation", *fixes)]
    return SimpleNamespace(arrivals=arrivals, drops=drops)


def test_a_silence_begins_with_the_last_fix_and_ends_with_the_next():
    assert silences(material([0.0, 1.0, 2.0, 8.0, 9.0, 10.0])) == ((2.0, 8.0),)


def test_each_silence_is_told():
    assert silences(material([0, 1, 2, 8, 9, 10, 20, 21, 22])) == ((2.0, 8.0), (10.0, 20.0))


@pytest.mark.parametrize("stamps_s", [[], [3.0], [0.0, 1.0, 2.0, 3.0]])
def test_without_a_gap_there_is_none(stamps_s):
    assert silences(material(stamps_s)) == ()


@pytest.mark.parametrize(("gap_s", "is_silence"), [(5.0, False), (5.1, True)])
def test_slow_fixes_are_missed_after_two_and_a_half_intervals(gap_s, is_silence):
    stamps_s = [0.0, 2.0, 4.0, 4.0 + gap_s, 6.0 + gap_s, 8.0 + gap_s]
    assert bool(silences(material(stamps_s))) == is_silence


@pytest.mark.parametrize(("gap_s", "is_silence"), [(1.0, False), (1.25, True)])
def test_fast_fixes_are_missed_after_a_second(gap_s, is_silence):
    stamps_s = [0.0, 0.125, 0.25, 0.25 + gap_s, 0.375 + gap_s, 0.5 + gap_s]
    assert bool(silences(material(stamps_s))) == is_silence


def test_fixes_of_two_antennas_at_one_time_are_one():
    assert silences(material([0.0, 0.0, 2.0, 2.0, 4.0, 4.0, 8.0, 8.0])) == ()


def test_a_simulated_outage_is_a_silence():
    stamps_s = [float(second) for second in range(12)]
    assert silences(material(stamps_s, Drop("gnss", 3.0, 8.0))) == ((2.0, 8.0),)
    assert silences(material(stamps_s, Drop("imu", 3.0, 8.0))) == ()
