"""A mission is watched at the port that an option names, or at the usual one."""

import pytest

from executive.commands.missions.watching import Watchers, groot_told, watchers


@pytest.mark.parametrize(
    ("groot", "groot_port", "live", "live_port", "ports"),
    [
        (False, None, False, None, (None, None)),
        (True, None, False, None, (1667, None)),
        (False, None, True, None, (None, 9876)),
        (False, 2000, False, None, (2000, None)),
        (True, 2000, True, 3000, (2000, 3000)),
    ],
)
def test_a_port_alone_asks_for_watching_too(groot, groot_port, live, live_port, ports):
    found = watchers(groot=groot, groot_port=groot_port, live=live, live_port=live_port)
    assert found == Watchers(*ports)


def test_a_person_is_told_the_port():
    assert groot_told(1700) == "Groot2 and btview connect with 127.0.0.1, port 1700"
