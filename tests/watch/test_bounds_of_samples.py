"""Joint and inertial samples are refused from the machine's own bounds on, and not before."""

from dataclasses import replace

import numpy as np
import pytest

from executive.machine.machine import load_machine
from executive.machine.sensor import Encoders, Imu
from executive.messages.command import START_TOLERANCE
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.watch.plausible import SIGMAS, JointBounds, TurnRate, imu_refusal

MACHINE = load_machine("m545")
ENCODERS = next(s for s in MACHINE.sensors_of("encoders") if isinstance(s, Encoders))
BOUNDS = JointBounds(MACHINE, ENCODERS)
JOINTS = (*MACHINE.joints, MACHINE.jaw)
COUNT = len(JOINTS)
ENDS = np.array([(joint.lower, joint.upper) for joint in JOINTS])  # infinite where it turns on
MIDDLE = np.where(np.isfinite(ENDS), ENDS, 0.0).mean(axis=1)
NUMBERS = range(COUNT)
MARGIN = [2.0] * (COUNT - 1) + [6.0]  # of the speed: a sliding stone drives the jaws
ON_CABIN = next(s for s in MACHINE.sensors_of("imu") if s.link == MACHINE.cabin_link)
ON_BASE = next(s for s in MACHINE.sensors_of("imu") if s.link == MACHINE.base_link)


def sample(stamp_s=1.0, names=MACHINE.joint_names, **values):
    given = {"position": MIDDLE, "velocity": np.zeros(COUNT), "effort": np.zeros(COUNT)}
    given |= values
    return JointSample(stamp_s, names, **given)


def only(number, value, base=None):
    found = (np.zeros(COUNT) if base is None else base).copy()
    found[number] = value
    return found


@pytest.mark.parametrize("number", NUMBERS)
def test_a_joint_is_within_its_range_but_for_the_tolerance_of_a_start(number):
    joint = JOINTS[number]
    for end, sign in ((joint.lower, -1), (joint.upper, 1)):
        if not np.isfinite(end):
            assert BOUNDS.refusal(sample(position=only(number, sign * 1e3, MIDDLE))) == ""
            continue
        near = only(number, end + 0.99 * sign * START_TOLERANCE, MIDDLE)
        beyond = only(number, end + 1.01 * sign * START_TOLERANCE, MIDDLE)
        assert BOUNDS.refusal(sample(position=near)) == ""
        told = f"{joint.name} is at {beyond[number]:.4g}, outside its range"
        assert BOUNDS.refusal(sample(position=beyond)) == told


@pytest.mark.parametrize("number", NUMBERS)
def test_a_joint_moves_no_faster_than_a_multiple_of_its_limit(number):
    joint = JOINTS[number]
    most = MARGIN[number] * joint.max_velocity + SIGMAS * ENCODERS.velocity_noise
    for sign in (-1, 1):
        assert BOUNDS.refusal(sample(velocity=only(number, 0.999 * sign * most))) == ""
        told = BOUNDS.refusal(sample(velocity=only(number, 1.001 * sign * most)))
        assert told.startswith(f"{joint.name} moves at ")
        assert told.endswith(", faster than it can")


@pytest.mark.parametrize("number", NUMBERS)
def test_a_drive_has_no_more_effort_than_its_limit_and_its_noise(number):
    joint = JOINTS[number]
    most = (1.1 + SIGMAS * ENCODERS.effort_noise) * joint.max_effort
    for sign in (-1, 1):
        assert BOUNDS.refusal(sample(effort=only(number, 0.999 * sign * most))) == ""
        told = BOUNDS.refusal(sample(effort=only(number, 1.001 * sign * most)))
        assert told.startswith(f"{joint.name} has the effort ")
        assert told.endswith(", beyond its limit")


@pytest.mark.parametrize("number", NUMBERS)
def test_a_joint_goes_no_farther_between_samples_than_it_can(number):
    joint = JOINTS[number]
    is_length = number < COUNT - 1 and MACHINE.joints[number].kind == "prismatic"
    noise = ENCODERS.length_noise_m if is_length else ENCODERS.angle_noise_rad
    most = 2 * SIGMAS * noise + MARGIN[number] * joint.max_velocity * 0.02
    before = sample(1.0)
    for sign in (-1, 1):
        near = sample(1.02, position=only(number, MIDDLE[number] + 0.999 * sign * most, MIDDLE))
        far = sample(1.02, position=only(number, MIDDLE[number] + 1.001 * sign * most, MIDDLE))
        assert BOUNDS.step(before, near) == ""
        assert BOUNDS.step(before, far) == f"{joint.name} has jumped by {1.001 * most:.4g}"


def test_samples_of_other_joints_are_refused_with_both_lists():
    names = ("J_OTHER", *MACHINE.joint_names[1:])
    told = BOUNDS.refusal(sample(names=names))
    expected = ", ".join(MACHINE.joint_names)
    assert told == f"joints {', '.join(names)}, expected {expected}"


def inertial(imu, rate=(0.0, 0.0, 0.0), force=(0.0, 0.0, 9.81), stamp_s=1.0):
    """Return a sample of a sensor with a rate in the axes of its link [rad/s]."""
    rate = imu.T_link_sensor[:3, :3].T @ np.asarray(rate)
    return ImuSample(stamp_s, imu.name, rate, np.asarray(force))


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1, 1])
def test_an_inertial_sensor_measures_within_its_ranges(axis, sign):
    at = np.eye(3)[axis] * sign
    still = np.zeros(3)
    for rate, force, told in (
        (0.999 * at * ON_CABIN.gyro_range_rad_s, still, ""),
        (1.001 * at * ON_CABIN.gyro_range_rad_s, still, "rad/s is beyond its range of "),
        (still, 0.999 * at * ON_CABIN.accel_range_m_s2, ""),
        (still, 1.001 * at * ON_CABIN.accel_range_m_s2, "m/s² is beyond its range of "),
    ):
        refusal = imu_refusal(ON_CABIN, ImuSample(1.0, ON_CABIN.name, rate, force))
        assert (told in refusal) if told else refusal == ""


TURN = MACHINE.turn_joint
INDEX = MACHINE.joint_names.index(TURN)
AXIS = np.array(MACHINE.joints[INDEX].axis)


def turning(speed, angle=0.4):
    return sample(position=only(INDEX, angle, MIDDLE), velocity=only(INDEX, speed))


def check(imu, own, other_imu, other, joints):
    return TurnRate(MACHINE).refusal(imu, own, (other_imu, other), joints)


def test_a_cabin_that_turns_on_a_standing_chassis_is_no_contradiction():
    joints = turning(0.5)
    cabin, base = inertial(ON_CABIN, 0.5 * AXIS), inertial(ON_BASE)
    assert check(ON_CABIN, cabin, ON_BASE, base, joints) == ""
    assert check(ON_BASE, base, ON_CABIN, cabin, joints) == ""


def test_a_chassis_that_pitches_takes_its_cabin_along_in_the_cabins_axes():
    """The chassis pitches; the cabin, turned by 90°, sees it as a roll beside its own turn."""
    joints = turning(0.5, angle=np.pi / 2)
    base = inertial(ON_BASE, (0.0, 3.0, 0.0))
    cabin = inertial(ON_CABIN, np.array([3.0, 0.0, 0.0]) + 0.5 * AXIS)
    assert check(ON_CABIN, cabin, ON_BASE, base, joints) == ""
    assert check(ON_BASE, base, ON_CABIN, cabin, joints) == ""
    wrong = inertial(ON_CABIN, np.array([0.0, 3.0, 0.0]) + 0.5 * AXIS)
    told = check(ON_CABIN, wrong, ON_BASE, base, joints)
    assert told == f"{3 * np.sqrt(2):.3f} rad/s off {ON_BASE.name} and the turn joint"


def test_of_two_that_disagree_the_one_is_refused_that_a_standing_chassis_does_not_explain():
    joints, base = turning(0.0), inertial(ON_BASE)
    wild = inertial(ON_CABIN, (0.0, 0.0, 4.0))
    assert "4.000 rad/s off" in check(ON_CABIN, wild, ON_BASE, base, joints)
    assert check(ON_BASE, base, ON_CABIN, wild, joints) == ""
    wild = inertial(ON_BASE, (4.0, 0.0, 0.0))
    cabin = inertial(ON_CABIN)
    assert "4.000 rad/s off" in check(ON_BASE, wild, ON_CABIN, cabin, joints)
    assert check(ON_CABIN, cabin, ON_BASE, wild, joints) == ""


@pytest.mark.parametrize("which", ["joints", "other"])
@pytest.mark.parametrize("apart_s", [0.0, 0.05])
def test_samples_of_other_times_may_differ_by_what_the_joint_gains_meanwhile(which, apart_s):
    joints, base = turning(0.0), inertial(ON_BASE)
    if which == "joints":
        joints = replace(joints, stamp_s=1.0 - apart_s)
    else:
        base = replace(base, stamp_s=1.0 - apart_s)
    noises = [(one.gyro_noise_rad_s, one.gyro_bias_rad_s) for one in (ON_CABIN, ON_BASE)]
    variance = ENCODERS.velocity_noise**2 + np.square(noises).sum()
    gains = 2 * MACHINE.joints[INDEX].max_acceleration * (apart_s + 1 / ON_CABIN.rate_hz)
    limit = SIGMAS * np.sqrt(variance) + gains
    for share, is_refused in ((0.999, False), (1.001, True)):
        own = inertial(ON_CABIN, share * limit * AXIS)
        assert (check(ON_CABIN, own, ON_BASE, base, joints) != "") is is_refused
    assert isinstance(ON_CABIN, Imu)
