"""A joint off its path, out of its range or at its full effort is told; so is a broken fence."""

import numpy as np
import pytest

from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine
from executive.messages.command import Follow, MoveJaws
from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory
from executive.watch.motion import MotionWatch
from executive.watch.rules import GeofenceRule, Rule, TrackingRule

MACHINE = load_machine("m545")
ARM = tuple(MACHINE.arm_names)
MIDDLE = np.mean(np.clip([MACHINE.lower, MACHINE.upper], -np.pi, np.pi), axis=0)
STANCE = MACHINE.stance
SPEED = 0.2
EVERY = {name: Rule(do="tell") for name in ("joint_limits", "effort")}
RULES = EVERY | {"tracking": TrackingRule(do="tell")}


def sample(stamp_s, q, **efforts):
    """Return a measurement of all joints, those of the arm at q."""
    at = dict(zip(ARM, q, strict=True))
    names = MACHINE.joint_names
    positions = [at.get(name, 0.0) for name in names]
    return JointSample(
        stamp_s, names, positions, np.zeros(len(names)), [efforts.get(name, 0.0) for name in names]
    )


def path(lasts_s=4.0):
    """All joints begin in the middle of their ranges and move evenly."""
    times = np.linspace(0.0, lasts_s, 9)
    speed = np.full((9, len(ARM)), SPEED)
    return JointTrajectory(ARM, times, MIDDLE + SPEED * times[:, None], speed)


def watch(place=None):
    return MotionWatch(MACHINE, lambda: place)


def following(began_s=10.0):
    one = watch()
    one.command(Follow(path()), began_s)
    return one


def off(joint, by):
    return np.where(np.arange(len(ARM)) == joint, by, 0.0)


def test_nothing_is_wrong_before_the_first_command():
    assert watch().troubles(sample(1.0, MIDDLE), RULES) == {}


@pytest.mark.parametrize("lag_s", [0.0, 0.5 * STANCE.tracking_lag_s, STANCE.tracking_lag_s])
def test_a_joint_may_lag_as_declared(lag_s):
    q = path().at(2.0 - lag_s)[0]
    assert following().troubles(sample(12.0, q), RULES) == {}


@pytest.mark.parametrize("joint", range(len(ARM)))
@pytest.mark.parametrize("side", [-1, 1])
def test_a_joint_that_is_off_its_path_by_more_than_declared_is_named(joint, side):
    nearest = path().at(2.0 if side > 0 else 2.0 - STANCE.tracking_lag_s)[0]
    near = nearest + off(joint, side * 0.98 * STANCE.tracking_error)
    far = nearest + off(joint, side * 1.02 * STANCE.tracking_error)
    assert "tracking" not in following().troubles(sample(12.0, near), RULES)
    told = following().troubles(sample(12.0, far), RULES)["tracking"]
    assert told == f"{ARM[joint]} is {1.02 * STANCE.tracking_error:.3f} off its path"
    assert "tracking" not in following().troubles(sample(12.0, far), EVERY)


def test_after_a_stop_only_the_path_counts_and_not_the_time():
    one = following()
    at_two_s = path().at(2.0)[0]
    assert "tracking" in one.troubles(sample(14.0, at_two_s), RULES)
    one.stopped()
    assert one.troubles(sample(14.0, at_two_s), RULES) == {}
    aside = at_two_s + off(1, 3.0 * STANCE.tracking_error)
    assert "off its path" in one.troubles(sample(14.0, aside), RULES)["tracking"]
    one.command(Follow(path()), 14.0)
    assert "tracking" in one.troubles(sample(14.0, at_two_s), RULES)


def test_a_command_of_the_jaws_leaves_the_path_as_it_is():
    one = following()
    one.command(MoveJaws(0.0, 1000.0), 12.0)
    assert one.troubles(sample(12.0, path().at(2.0)[0]), RULES) == {}


@pytest.mark.parametrize("joint", [j for j in range(len(ARM)) if np.isfinite(MACHINE.upper[j])])
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_a_joint_beyond_its_range_is_named(joint, end):
    stop, side = (MACHINE.lower, -1.0) if end == "lower" else (MACHINE.upper, 1.0)
    at = MIDDLE.copy()
    at[joint] = stop[joint] + side * 0.019
    assert watch().troubles(sample(1.0, at), RULES) == {}
    at[joint] = stop[joint] + side * 0.05
    told = watch().troubles(sample(1.0, at), RULES)
    assert told == {"joint_limits": f"{ARM[joint]} is 0.050 beyond its range"}


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_drive_at_its_full_effort_is_named(sign):
    joint = MACHINE.joints[1]
    strained = sample(1.0, MIDDLE, **{joint.name: sign * joint.max_effort})
    assert watch().troubles(strained, RULES) == {"effort": f"{joint.name} needs its full effort"}
    sound = sample(1.0, MIDDLE, **{joint.name: sign * 0.99 * joint.max_effort})
    assert watch().troubles(sound, RULES) == {}


def test_the_gripper_stays_within_a_circle_in_the_map():
    place = np.eye(4)
    place[:2, 3] = (100.0, 50.0)
    at = (place @ Kinematics(MACHINE).gripper(MIDDLE))[:2, 3]
    centre = (float(at[0]) - 3.0, float(at[1]) - 4.0)
    inside, outside = (GeofenceRule(do="tell", radius=r, centre=centre) for r in (5.01, 4.99))
    here = sample(1.0, MIDDLE)
    assert watch(place).troubles(here, {"geofence": inside}) == {}
    told = watch(place).troubles(here, {"geofence": outside})
    assert told == {"geofence": "the gripper is 5.00 m from the centre, outside 4.99 m"}
    assert watch(None).troubles(here, {"geofence": outside}) == {}
