"""Settings of the tick loop and of long verbs: what holds where a mission says nothing."""

import pytest
from pydantic import ValidationError

from executive.tree.job_settings import JobSettings
from executive.tree.loop_settings import LoopSettings


def test_a_loop_ticks_twenty_times_a_second_for_at_most_two_hours() -> None:
    loop = LoopSettings()
    assert (loop.tick, loop.time_limit, loop.heartbeat_limit) == (0.05, 7200.0, 0.2)
    assert (loop.runner, loop.late_ticks, loop.jobs) == (None, None, JobSettings())


def test_a_verb_has_twenty_times_its_latency_and_at_least_half_a_minute() -> None:
    jobs = JobSettings()
    assert (jobs.limit_factor, jobs.least_limit) == (20.0, 30.0)
    assert (jobs.start_limit, jobs.memory) == (120.0, 8e9)


@pytest.mark.parametrize(
    ("kind", "name", "good", "bad"),
    [
        (LoopSettings, "tick", (0.001, 1.0), (0.0009, 1.01)),
        (LoopSettings, "time_limit", (0.5,), (0.0,)),
        (LoopSettings, "late_ticks", (1,), (0,)),
        (LoopSettings, "heartbeat_limit", (0.5,), (0.0,)),
        (JobSettings, "limit_factor", (1.0,), (0.99,)),
        (JobSettings, "least_limit", (0.5,), (0.0,)),
        (JobSettings, "start_limit", (0.5,), (0.0,)),
        (JobSettings, "memory", (1.0,), (0.0,)),
    ],
)
def test_limits_have_bounds(kind: type, name: str, good: tuple, bad: tuple) -> None:
    for value in good:
        assert getattr(kind(**{name: value}), name) == value
    for value in bad:
        with pytest.raises(ValidationError, match=name):
            kind(**{name: value})
