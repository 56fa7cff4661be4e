"""The collector looks at what the loop made; on the wall clock, free pages are given back."""

import gc
import sys
import threading

import pytest

from executive.mission import garbage
from executive.mission.garbage import left_alone, trimmer


@pytest.fixture(autouse=True)
def usual_collector():
    """The collector as Python starts it: other tests of the process may have left it otherwise."""
    was_on, thresholds = gc.isenabled(), gc.get_threshold()
    gc.enable()
    gc.set_threshold(700, 10, 10)
    yield
    gc.set_threshold(*thresholds)
    if not was_on:
        gc.disable()


class Ring:
    """Garbage that only the collector can find."""

    def __init__(self):
        self.itself = self


def test_garbage_of_the_loop_is_found_although_the_frozen_objects_are_many(monkeypatch):
    many = [[] for _ in range(400_000)]  # a collection of all would wait for 100,000 new objects
    collected = []
    monkeypatch.setattr(garbage, "trimmer", lambda: None)

    def note(phase, info):
        if phase == "stop" and info["generation"] == 2:
            collected.append(info["collected"])

    with left_alone(is_real_time=True):
        gc.callbacks.append(note)
        try:
            kept = []
            for _ in range(200_000):  # some 85,000 are one round of the collector
                kept.append(Ring())
                del kept[:-2000]  # old enough for the last generation, as what a queue held
        finally:
            gc.callbacks.remove(note)
    assert len(many) == 400_000
    assert collected


def test_tuples_that_python_keeps_for_later_ones_are_given_back():
    def made(count):
        for _ in range(count):
            tuple(i for i in range(7))  # made large and cut: takes none of the kept ones of seven

    gc.collect()
    before = sys.getallocatedblocks()
    made(1_500)
    grown = sys.getallocatedblocks() - before
    garbage.return_free_memory()
    assert grown > 1_000
    assert sys.getallocatedblocks() - before < 500


def test_free_pages_are_given_back_until_the_run_ends(monkeypatch):
    given = threading.Semaphore(0)
    monkeypatch.setattr(garbage, "RETURN_PERIOD_S", 0.001)
    monkeypatch.setattr(garbage, "trimmer", lambda: lambda kept_bytes: given.release() or 1)
    before = threading.active_count()
    with left_alone(is_real_time=True):
        for _ in range(3):
            assert given.acquire(timeout=30.0)
    assert threading.active_count() == before


@pytest.mark.parametrize("is_real_time", [False, True])
def test_what_a_run_begins_with_is_looked_at_again_only_when_it_has_ended(is_real_time):
    with left_alone(is_real_time):
        assert gc.get_freeze_count() > 0
    assert gc.get_freeze_count() == 0


def test_the_c_library_gives_pages_back_or_there_is_no_thread():
    trim = trimmer()
    assert trim is None or trim(0) in (0, 1)
