"""The rules of watched conditions: when a mission holds, goes on, and stops."""

import pytest

from executive.machine.machine import load_machine
from executive.watch.rules import Rule
from executive.watch.watch import Watch, Wish

MACHINE = load_machine("m545")
SICK = {"imu_cabin": "imu_cabin: no good sample for 0.05 s"}


def wishes(rules, troubles):
    """Return what a watch asks for in one step a second, with what is wrong then."""
    events = []
    watch = Watch(MACHINE, {name: Rule(**rule) for name, rule in rules.items()}, events.append)
    return [watch.step(one, float(i)).wish for i, one in enumerate(troubles)], events


def test_it_holds_until_all_was_well_for_long_enough():
    asked, events = wishes({"imu": {"do": "hold", "settle": 2.0}}, [{}, SICK, SICK, {}, {}, {}, {}])
    assert asked == [Wish.GO_ON, *[Wish.HOLD] * 4, Wish.GO_ON, Wish.GO_ON]
    assert [event.kind for event in events] == ["condition_broken", "condition_restored"]


def test_a_wait_that_is_over_stops_or_goes_on_as_the_rule_says():
    stop, _ = wishes({"imu": {"do": "hold", "wait": 3.0}}, [SICK] * 5)
    assert stop == [*[Wish.HOLD] * 3, Wish.STOP, Wish.STOP]
    go_on, _ = wishes({"imu": {"do": "hold", "wait": 3.0, "then": "go_on"}}, [SICK] * 6)
    assert go_on == [*[Wish.HOLD] * 3, *[Wish.GO_ON] * 3]


def test_a_rule_acts_after_its_time_and_that_of_a_sensor_goes_before_that_of_its_kind():
    late, _ = wishes({"imu": {"do": "stop", "after": 2.0}}, [SICK] * 3)
    assert late == [Wish.GO_ON, Wish.GO_ON, Wish.STOP]
    own, _ = wishes({"imu": {"do": "stop"}, "imu_cabin": {"do": "tell"}}, [SICK])
    assert own == [Wish.GO_ON]


@pytest.mark.parametrize("rules", [{}, {"imu": {"do": "tell"}}, {"gnss": {"do": "stop"}}])
def test_without_a_rule_that_acts_it_only_tells(rules):
    asked, events = wishes(rules, [SICK, SICK])
    assert asked == [Wish.GO_ON, Wish.GO_ON]
    assert [event.kind for event in events] == ["condition_broken"]
