"""What a supervisor reads from the page: silence beyond its limit, activity, texts and status."""

import os
import signal
import time
from types import SimpleNamespace

import pytest

from executive.supervision import beacon as beacon_module
from executive.supervision.beacon import Beacon, beacon, inherit


def silent_loop():
    page = Beacon()
    page.watch(0.05, 0.05)
    time.sleep(0.1)
    return page


def test_silence_and_old_joints_count_from_the_last_sign():
    page = silent_loop()
    assert page.silent_s() >= 0.1
    assert page.joints_age_s() >= 0.1
    page.watch(60.0, 60.0)
    assert page.silent_s() == page.joints_age_s() == 0.0


def test_time_in_which_the_supervisor_was_held_up_does_not_count():
    page = silent_loop()
    just_now_s = time.monotonic() + 60.0  # a busy computer may hold this test up, too
    assert page.silent_s(just_now_s) == page.joints_age_s(just_now_s) == 0.0
    assert page.silent_s() > 0.0


def test_a_loop_that_is_not_watched_is_never_silent():
    page = silent_loop()
    page.unwatch()
    assert page.silent_s() == page.joints_age_s() == 0.0


def test_a_sign_of_life_is_never_read_half_written():
    """A sign that read as zero for a moment stopped machines whose loop was well."""
    page = Beacon()
    page.watch(60.0, 60.0)
    writer = os.fork()
    while not writer:
        page.beat()
        page.see_joints()
    try:
        until_s = time.monotonic() + 0.5
        looks = [
            page.silent_s() + page.joints_age_s()
            for _ in iter(lambda: time.monotonic() < until_s, False)
        ]
    finally:
        os.kill(writer, signal.SIGKILL)
        os.waitpid(writer, 0)
    assert len(looks) > 100
    assert max(looks) == 0.0


def test_a_text_is_never_read_half_written():
    """An address that was cut off would have been one of another machine, or of none."""
    page = Beacon()
    texts = {"unix:" + "a" * 4000, "127.0.0.1:" + "2" * 3000}
    writer = os.fork()
    while not writer:
        for text in texts:
            page.name(machine=text)
    try:
        until_s = time.monotonic() + 1.0
        looks = [page.text("machine") for _ in iter(lambda: time.monotonic() < until_s, False)]
    finally:
        os.kill(writer, signal.SIGKILL)
        os.waitpid(writer, 0)
    assert len(looks) > 100
    assert set(looks) <= texts | {""}
    assert texts & set(looks)


@pytest.fixture
def now(monkeypatch):
    """A monotonic clock that is set by hand."""
    now = SimpleNamespace(s=50.0)
    monkeypatch.setattr(beacon_module, "time", SimpleNamespace(monotonic=lambda: now.s))
    return now


def test_silence_and_joints_are_too_old_beyond_their_limits_alone(now):
    page = Beacon()
    page.watch(0.3, 0.5)
    told = []
    for now.s, sign in [
        (50.3, None), (50.4, None), (50.6, page.beat), (50.7, page.see_joints), (51.0, None),
    ]:  # fmt: skip
        if sign:
            sign()
        told.append((round(page.silent_s(), 9), round(page.joints_age_s(), 9)))
    assert told == [(0.0, 0.0), (0.4, 0.0), (0.0, 0.6), (0.0, 0.0), (0.4, 0.0)]
    page.watch(0.3, 0.0)  # without joints
    now.s += 10.0
    assert (page.silent_s(), page.joints_age_s()) == (10.0, 0.0)


def test_a_verb_is_overdue_from_its_limit_to_its_end(now):
    page = Beacon()
    assert (page.is_computing(), page.overdue_s(), page.activity()) == (False, 0.0, {})
    page.begin(1, {"verb": "move"}, 2.0)
    assert (page.is_computing(), page.overdue_s()) == (True, 0.0)
    assert page.activity() == {"verb": "move"}
    now.s += 2.5
    assert page.overdue_s() == 0.5
    page.end(1)
    assert (page.is_computing(), page.overdue_s(), page.activity()) == (False, 0.0, {})


def test_a_verb_that_gets_more_time_is_overdue_after_it(now):
    page = Beacon()
    page.begin(1, {"verb": "propose"}, 2.0)
    now.s += 1.9
    page.extend(1, 3.0)
    page.extend(2, 0.1)  # one that has ended already
    now.s += 3.5
    assert (page.overdue_s(), page.activity()) == (pytest.approx(0.5), {"verb": "propose"})


def test_of_verbs_in_several_threads_the_one_that_has_to_end_first_is_watched(now):
    """The end of a short verb does not hide that a long one hangs."""
    page = Beacon()
    page.begin(1, {"verb": "merge"}, 30.0)
    page.begin(2, {"verb": "observe"}, 5.0)
    assert page.activity() == {"verb": "observe"}
    now.s += 1.0
    page.end(2)
    page.end(2)  # once more, by the thread that was given up
    assert page.activity() == {"verb": "merge"}
    now.s += 30.0
    assert (page.is_computing(), page.overdue_s()) == (True, 1.0)
    page.end(1)
    assert (page.is_computing(), page.overdue_s(), page.activity()) == (False, 0.0, {})


def test_what_the_loop_is_in_is_the_innermost(now):
    page = Beacon()
    tick, verb = {"component": "behaviour 'Dig'"}, {"component": "x", "verb": "see"}
    assert page.loop() == {}
    page.enter(beacon_module.note_of(tick))
    page.enter(beacon_module.note_of(verb))
    assert page.loop() == verb
    page.begin(1, {"verb": "move"}, 2.0)
    assert (page.loop(), page.activity()) == (verb, {"verb": "move"})
    page.leave()
    assert page.loop() == tick
    page.leave()
    assert page.loop() == {}


def test_of_a_run_that_is_given_up_nothing_is_watched_and_its_verb_stays_known(now):
    page = Beacon()
    page.watch(0.3, 0.3)
    page.begin(1, {"verb": "move"}, 1.0)
    now.s += 5.0
    page.forget()
    assert (page.silent_s(), page.joints_age_s(), page.overdue_s()) == (0.0, 0.0, 0.0)
    assert not page.is_computing()
    assert page.activity() == {"verb": "move"}


@pytest.mark.parametrize("status", [0, 3])
def test_a_run_that_ended_has_its_status_and_is_watched_no_more(now, status):
    page = Beacon()
    page.watch(0.3, 0.3)
    assert page.status() is None
    page.finish(status)
    now.s += 5.0
    assert (page.status(), page.silent_s()) == (status, 0.0)


def test_texts_are_kept_apart_and_cut_to_their_room():
    page = Beacon()
    page.name(run_dir="runs/Straße", machine="unix:/tmp/m")
    page.name(mission="m" * 5000, stack="a\0b")
    assert page.text("run_dir") == "runs/Straße"
    assert page.text("machine") == "unix:/tmp/m"
    assert page.text("mission") == "m" * 4092
    assert page.text("stack") == "ab"
    assert page.text("activity") == ""
    page.name(machine="")
    assert page.text("machine") == ""


def test_an_activity_that_is_no_mapping_is_none():
    page = Beacon()
    for text in ("[1]", '{"verb": "mo'):
        page.name(activity=text)
        assert page.activity() == {}


def test_a_process_has_one_page_which_its_supervisor_may_give_it(monkeypatch):
    monkeypatch.setattr(beacon_module, "_inherited", [])
    first = beacon()
    assert beacon() is first
    given = Beacon()
    inherit(given)
    assert beacon() is given
