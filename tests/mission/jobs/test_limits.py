"""How long a verb may compute, and how much memory it may take."""

import pytest

from executive.interfaces.plugin import Plugin
from executive.mission.jobs.limits import DEFAULT, Limits
from executive.tree.job_settings import JobSettings


class Slow(Plugin):
    latency_s = {"segment": 8.0, "look": 0.1, "search": 2.0}
    limit_s = {"search": 600.0}


LIMITS = Limits(factor=5.0, least_s=3.0, start_s=60.0, memory_bytes=100)


@pytest.mark.parametrize(
    ("verb", "limit_s"), [("segment", 40.0), ("look", 3.0), ("unheard_of", 3.0), ("search", 600.0)]
)
def test_a_verb_may_take_a_multiple_of_its_latency_unless_its_plugin_says_more(verb, limit_s):
    assert LIMITS.time_s(Slow(), verb) == limit_s


def test_limits_are_those_of_the_mission_file():
    settings = JobSettings(limit_factor=7, least_limit="4 s", start_limit="50 s", memory="2 GiB")
    assert Limits.of(settings) == Limits(7.0, 4.0, 50.0, 2 * 2**30)
    assert Limits.of(JobSettings()) == DEFAULT
