"""How long a thread waited for a core, as Linux tells it."""

import os
import threading
import time

import pytest

from executive.mission.jobs.processor_time import ready_s


def computed(amount_s: float) -> None:
    end = time.thread_time() + amount_s
    while time.thread_time() < end:
        pass


@pytest.mark.skipif(not os.path.exists("/proc/self/schedstat"), reason="not Linux")
def test_of_two_processes_on_one_core_one_waits() -> None:
    cores = os.sched_getaffinity(0)
    child = os.fork()
    if child == 0:  # on the same core as its parent
        os.sched_setaffinity(0, {min(cores)})
        computed(1.0)
        os._exit(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        before_s = ready_s(), ready_s(os.getpid(), threading.get_native_id())
        computed(0.15)
        after_s = ready_s(), ready_s(os.getpid(), threading.get_native_id())
    finally:
        os.sched_setaffinity(0, cores)
        os.kill(child, 9)
        os.waitpid(child, 0)
    assert after_s[0] - before_s[0] > 0.05
    assert after_s[1] - before_s[1] > 0.05


@pytest.mark.parametrize("process", [0, 2**30])
def test_what_the_system_does_not_tell_is_none(process: int) -> None:
    assert ready_s(process) == 0.0
