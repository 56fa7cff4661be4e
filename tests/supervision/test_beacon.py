"""What a supervisor reads from the page: silence beyond the limit, and since when it counts."""

import os
import signal
import time

from executive.supervision.beacon import Beacon


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
