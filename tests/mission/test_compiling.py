"""Tests of what a run says of the numerical code that it compiles."""

import time

from numba import njit

from executive.mission import compiling
from executive.mission.compiling import NOTICE, Compiling


def _fresh():
    """Return a function that nobody has compiled, and that calls another one."""

    @njit
    def inner(x):
        return x * x

    @njit
    def outer(x):
        return inner(x) + 1.0

    return outer


def test_what_compiling_takes_is_measured_once(monkeypatch):
    monkeypatch.setattr(compiling, "TOLD_AFTER_S", 0.0)
    told = []
    begun_s = time.process_time()
    measured = Compiling(told.append)
    with measured.watching():
        assert _fresh()(2.0) == 5.0
        assert _fresh()(3.0) == 10.0
    assert 0.0 < measured.spent_s <= time.process_time() - begun_s  # the inner one counts once
    assert told == [NOTICE]


def test_what_is_compiled_already_says_nothing(monkeypatch):
    function = _fresh()
    function(1.0)
    monkeypatch.setattr(compiling, "TOLD_AFTER_S", 0.0)
    told = []
    measured = Compiling(told.append)
    with measured.watching():
        function(2.0)
    assert measured.spent_s == 0.0
    assert told == []


def test_a_moment_is_not_worth_a_notice():
    told = []
    measured = Compiling(told.append)
    with measured.watching():
        _fresh()(1.0)
    assert 0.0 < measured.spent_s < compiling.TOLD_AFTER_S
    assert told == []
