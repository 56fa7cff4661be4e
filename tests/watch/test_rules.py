"""Which conditions a machine can be watched for, and what is broken at a time."""

import pytest
from pydantic import ValidationError

from executive.machine.machine import load_machine
from executive.watch.rules import EstimateRule, GeofenceRule, Rule, TrackingRule, conditions_of
from executive.watch.watch import Decision, Watch, Wish

MACHINE = load_machine("m545")


def test_each_sensor_and_each_kind_of_sensors_is_a_condition_beside_those_of_the_motion():
    known = conditions_of(MACHINE)
    kinds = {sensor.kind for sensor in MACHINE.sensors.values()}
    of_rule = {*MACHINE.sensors, *kinds, "joint_limits", "effort", "pressure"}
    assert {name for name, rule in known.items() if rule is Rule} == of_rule
    own = {"estimate": EstimateRule, "tracking": TrackingRule, "geofence": GeofenceRule}
    assert {name: rule for name, rule in known.items() if rule is not Rule} == own


@pytest.mark.parametrize(
    ("given", "owner"),
    [
        ({"do": "stop", "wait": 3.0}, "wait belongs to `do: hold` and `do: fail`, not to `stop`"),
        ({"do": "fail", "settle": 3.0}, "settle belongs to `do: hold`, not to `fail`"),
        ({"do": "tell", "then": "go_on"}, "then belongs to `do: hold`, not to `tell`"),
        ({"do": "hold", "most": 5}, "most belongs to `do: fail`, not to `hold`"),
    ],
)
def test_a_setting_of_another_action_is_told_with_its_owner(given, owner):
    with pytest.raises(ValidationError, match=owner):
        Rule(**given)


@pytest.mark.parametrize(
    ("field", "bounds", "beyond"),
    [
        ("after", (0.0, 60.0), (-0.1, 60.1)),
        ("wait", (0.001, 3600.0), (0.0, 3600.1)),
        ("settle", (0.0, 60.0), (-0.1, 60.1)),
    ],
)
def test_times_of_a_rule_have_bounds(field, bounds, beyond):
    for value in bounds:
        assert getattr(Rule(do="hold", **{field: value}), field) == value
    for value in beyond:
        with pytest.raises(ValidationError):
            Rule(do="hold", **{field: value})


def test_a_rule_acts_after_its_own_time():
    assert Rule(do="stop", after=2.5).after_s(MACHINE) == 2.5
    assert TrackingRule(do="stop").after_s(MACHINE) == MACHINE.stance.settling_s
    assert TrackingRule(do="stop", after=0.0).after_s(MACHINE) == 0.0


def test_what_is_broken_is_told_with_its_newest_reason_until_it_is_whole():
    events = []
    watch = Watch(MACHINE, {"imu": Rule(do="stop", after=2.0)}, events.append)
    assert watch.broken() == {}
    assert watch.step({"imu": "late", "gnss": "lost"}, 1.0) == Decision(Wish.GO_ON)
    watch.step({"imu": "later"}, 1.75)
    assert watch.broken() == {"imu": "later"}
    (imu, gnss, restored) = events
    assert (imu.condition, imu.reason) == ("imu", "late")
    assert (gnss.condition, gnss.reason) == ("gnss", "lost")
    assert (restored.condition, restored.lasted_s) == ("gnss", 0.75)
    assert watch.step({"imu": "gone"}, 2.99).wish is Wish.GO_ON
    assert watch.step({"imu": "gone"}, 3.0) == Decision(Wish.STOP, "imu", "gone")


def test_of_several_conditions_one_that_stops_goes_first():
    rules = {"imu": Rule(do="hold"), "gnss": Rule(do="stop")}
    watch = Watch(MACHINE, rules, lambda event: None)
    assert watch.step({"imu": "late", "gnss": "lost"}, 1.0) == Decision(Wish.STOP, "gnss", "lost")


def test_a_hold_tells_what_it_waits_for_and_that_it_is_well_again():
    watch = Watch(MACHINE, {"imu": Rule(do="hold", settle=1.0)}, lambda event: None)
    assert watch.step({"imu": "late"}, 1.0) == Decision(Wish.HOLD, "imu", "late")
    assert watch.step({"imu": "later"}, 2.0) == Decision(Wish.HOLD, "imu", "later")
    assert watch.step({}, 3.0) == Decision(Wish.HOLD, "imu")
    assert watch.step({"imu": "again"}, 3.5) == Decision(Wish.HOLD, "imu", "again")
    assert watch.step({}, 4.0) == Decision(Wish.HOLD, "imu")
    assert watch.step({}, 4.9) == Decision(Wish.HOLD, "imu")
    assert watch.step({}, 5.0) == Decision(Wish.GO_ON, "imu", "imu is well again")
    assert watch.step({}, 5.1) == Decision(Wish.GO_ON)


def test_a_wait_that_is_over_tells_how_long_it_was():
    rule = Rule(do="hold", wait=3.0)
    watch = Watch(MACHINE, {"imu": rule}, lambda event: None)
    watch.step({"imu": "late"}, 1.0)
    told = Decision(Wish.STOP, "imu", "late; waited for 3 s")
    assert watch.step({"imu": "late"}, 3.99).wish is Wish.HOLD
    assert watch.step({"imu": "late"}, 4.0) == told
    excused = Watch(MACHINE, {"imu": Rule(do="hold", wait=3.0, then="go_on")}, lambda event: None)
    excused.step({"imu": "late"}, 1.0)
    told = Decision(Wish.GO_ON, "imu", "late; waited for 3 s")
    assert excused.step({"imu": "late"}, 4.0) == told
    assert excused.step({"imu": "late"}, 5.0) == Decision(Wish.GO_ON)  # it is excused
    excused.step({}, 6.0)
    assert excused.step({"imu": "late"}, 7.0).wish is Wish.HOLD  # and not for ever
