"""The rules of watched conditions: when a mission holds, goes on, and stops."""

import re

import pytest

from executive.machine.machine import load_machine
from executive.watch.rules import Rule, TrackingRule
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


def test_motions_fail_once_for_each_break_and_the_mission_stops_after_so_many():
    rule = {"imu": {"do": "fail", "most": 2}}
    asked, events = wishes(rule, [SICK, SICK, {}, SICK, {}, SICK])
    fails = [Wish.FAIL, Wish.GO_ON, Wish.GO_ON, Wish.FAIL, Wish.GO_ON]
    assert asked == [*fails, Wish.STOP]
    assert [event.kind for event in events].count("condition_broken") == 3


def test_what_stays_broken_after_a_motion_has_failed_for_it_stops_the_mission():
    watch = Watch(MACHINE, {"imu": Rule(do="fail", wait=3.0)}, lambda event: None)
    decisions = [watch.step(SICK, float(i)) for i in range(5)]
    asked = [Wish.FAIL, Wish.GO_ON, Wish.GO_ON, Wish.STOP, Wish.STOP]
    assert [one.wish for one in decisions] == asked
    told = f"{SICK['imu_cabin']}, 3 s after its rule has acted"
    assert decisions[3].reason == told


def test_a_hold_goes_before_a_failure_which_waits_for_its_end():
    rules = {"imu": {"do": "hold", "settle": 1.0}, "effort": {"do": "fail", "after": 1.0}}
    weak = {"effort": "J_BOOM needs its full effort"}
    asked, _ = wishes(rules, [SICK | weak, SICK | weak, weak, weak, weak])
    assert asked == [*[Wish.HOLD] * 3, Wish.GO_ON, Wish.FAIL]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"do": "stop", "most": 2}, "most belongs to `do: fail`, not to `stop`"),
        ({"do": "tell", "wait": 2}, "wait belongs to `do: hold` and `do: fail`, not to `tell`"),
        ({"do": "fail", "settle": 2}, "settle belongs to `do: hold`, not to `fail`"),
    ],
)
def test_a_setting_of_another_action_is_refused(given, told):
    with pytest.raises(ValueError, match=re.escape(told)):
        Rule(**given)


@pytest.mark.parametrize(("after", "least_s"), [({}, MACHINE.stance.settling_s), ({"after": 2}, 2)])
def test_an_arm_may_spring_for_as_long_as_its_drives_need_to_settle(after, least_s):
    watch = Watch(MACHINE, {"tracking": TrackingRule(do="stop", **after)}, lambda event: None)
    off = {"tracking": "J_BOOM is 0.120 off its path"}
    asked = [watch.step(off, now_s).wish for now_s in (0.0, 0.99 * least_s, 1.01 * least_s)]
    assert asked == [Wish.GO_ON, Wish.GO_ON, Wish.STOP]


def test_a_drive_that_lags_by_no_more_than_declared_settles_in_that_time():
    stance, dt_s = MACHINE.stance, 1e-4
    omega = 2.0 / stance.tracking_lag_s  # of a critically damped drive: it is 2/ω behind a ramp
    off, speed, last_s = 1.0, 0.0, 0.0
    for step in range(round(2.0 / dt_s)):
        speed -= (2 * omega * speed + omega**2 * off) * dt_s
        off += speed * dt_s
        last_s = step * dt_s if abs(off) > 0.02 else last_s
    assert last_s == pytest.approx(stance.settling_s, rel=0.01)
