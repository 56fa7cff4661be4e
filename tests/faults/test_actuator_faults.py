"""What a faulty drive makes of a command, and how far off a sound one it is; no simulator."""

import numpy as np
import pytest

from executive.faults.actuator_faults import FaultyActuator, Way
from executive.faults.description import ActuatorFault
from executive.interfaces.facilities import Breakable
from executive.machine.machine import load_machine
from executive.messages.command import Follow, MoveJaws, SwitchLidars
from executive.messages.trajectory import JointTrajectory

MACHINE = load_machine("m545")
NAMES = tuple(MACHINE.arm_names)
SPEED, LASTS_S = 0.1, 10.0
LAG_S = MACHINE.stance.tracking_lag_s


class Weak(Breakable):
    """Notes what its drives are left with."""

    def __init__(self):
        self.shares = {}

    def weaken(self, joint, share):
        self.shares[joint] = share


class Clock:
    def __init__(self):
        self.time_s = 0.0

    def __call__(self):
        return self.time_s


def even_motion():
    """All joints move evenly, from another position each."""
    times = np.linspace(0.0, LASTS_S, 11)
    start = 0.1 * np.arange(len(NAMES))
    speed = np.full((11, len(NAMES)), SPEED)
    return JointTrajectory(NAMES, times, start + SPEED * times[:, None], speed)


def faulty(actuator, how, **more):
    return FaultyActuator(ActuatorFault(at=1.0, actuator=actuator, how=how, **more), MACHINE)


def moved(trajectory):
    return trajectory.position[-1] - trajectory.position[0]


@pytest.mark.parametrize(("given", "share"), [({}, 0.5), ({"share": 0.2}, 0.2)])
@pytest.mark.parametrize("actuator", ["arm", NAMES[1]])
def test_a_sluggish_joint_makes_its_share_of_the_motion_and_the_others_all(actuator, given, share):
    asked = even_motion()
    made = faulty(actuator, "sluggish", **given).alter(Follow(asked), object()).trajectory
    slow = np.isin(NAMES, NAMES if actuator == "arm" else (actuator,))
    expected = np.where(slow, share, 1.0)
    assert moved(made) == pytest.approx(expected * SPEED * LASTS_S)
    assert made.velocity == pytest.approx(np.tile(expected * SPEED, (11, 1)))
    assert made.position[0] == pytest.approx(asked.position[0])


def test_a_joint_without_pressure_stays_where_it_is():
    made = faulty("arm", "no_pressure").alter(Follow(even_motion()), object()).trajectory
    assert moved(made) == pytest.approx(0.0)


def test_a_robot_that_simulates_the_loss_of_pressure_takes_the_command_as_it_is():
    command, robot = Follow(even_motion()), Weak()
    fault = faulty("arm", "no_pressure")
    assert fault.alter(command, robot) is command
    fault.begin(robot, pytest.fail, Way(Clock()))
    assert robot.shares == dict.fromkeys(NAMES, 0.0)
    fault.end(robot)
    assert robot.shares == dict.fromkeys(NAMES, 1.0)


def test_jaws_without_pressure_are_weakened_alone():
    robot = Weak()
    faulty("jaws", "no_pressure").begin(robot, pytest.fail, Way(Clock()))
    assert robot.shares == {MACHINE.jaw.name: 0.0}


@pytest.mark.parametrize("how", ["open", "no_pressure"])
def test_broken_jaws_open_and_do_not_close(how):
    sent = []
    fault = faulty("jaws", how)
    fault.begin(object(), sent.append, Way(Clock()))
    (opening,) = sent
    assert opening.position_rad == MACHINE.gripper.open_rad
    pressure_n = MACHINE.gripper.tip_force_n
    assert opening.force_n == pressure_n if how == "open" else opening.force_n < 0.01 * pressure_n
    assert fault.alter(MoveJaws(0.0, pressure_n), object()) is None


def test_sluggish_jaws_close_with_a_share_of_the_force():
    fault = faulty("jaws", "sluggish", share=0.25)
    assert fault.alter(MoveJaws(0.3, 8000.0), object()) == MoveJaws(0.3, 2000.0)
    assert fault.alter(MoveJaws(0.3, 0.0), object()).force_n > 0


def test_a_fault_leaves_the_other_drives_alone():
    switch, follow, close = SwitchLidars(True), Follow(even_motion()), MoveJaws(0.0, 1000.0)
    assert faulty("arm", "sluggish").alter(switch, object()) is switch
    assert faulty("arm", "sluggish").alter(close, object()) is close
    assert faulty("jaws", "sluggish").alter(follow, object()) is follow
    assert faulty("arm", "sluggish").is_of_arm
    assert not faulty("jaws", "sluggish").is_of_arm


def test_a_fault_in_the_middle_of_a_path_slows_the_rest_of_it():
    clock, sent = Clock(), []
    way = Way(clock)
    clock.time_s = 2.0
    way.take(Follow(even_motion()), Follow(even_motion()))
    clock.time_s = 6.0
    faulty("arm", "sluggish").begin(object(), sent.append, way)
    (command,) = sent
    rest = command.trajectory
    assert rest.duration_s == pytest.approx(6.0)
    assert rest.position[0] == pytest.approx(even_motion().at(4.0)[0])
    assert moved(rest) == pytest.approx(0.5 * SPEED * 6.0)


@pytest.mark.parametrize("change", ["nothing taken", "stopped", "at the end"])
def test_without_a_path_nothing_is_commanded_anew(change):
    clock, sent = Clock(), []
    way = Way(clock)
    if change != "nothing taken":
        way.take(Follow(even_motion()), Follow(even_motion()))
    if change == "stopped":
        way.stop()
    if change == "at the end":
        clock.time_s = LASTS_S - 0.1
    fault = faulty("arm", "sluggish")
    fault.begin(object(), sent.append, way)
    assert not sent
    if change != "at the end":
        assert fault.withheld(object(), way, 0.0) == 0.0


def test_a_drive_withholds_what_a_sound_one_with_its_lag_would_have_made_by_now():
    clock = Clock()
    way = Way(clock)
    way.take(Follow(even_motion()), Follow(even_motion()))
    clock.time_s = 5.0
    lagged = SPEED * (4.0 - LAG_S)  # since a fault that began after a second
    half, none = faulty("arm", "sluggish"), faulty("arm", "no_pressure")
    assert half.withheld(object(), way, 1.0) == pytest.approx(lagged - 0.5 * SPEED * 4.0)
    assert none.withheld(object(), way, 1.0) == pytest.approx(lagged)
    assert none.withheld(Weak(), way, 1.0) == pytest.approx(lagged)  # a valve or a brake holds it
    wrist = faulty("J_EE_YAW", "no_pressure")
    assert wrist.withheld(Weak(), way, 1.0) == pytest.approx(0.0, abs=1e-9)  # it coasts on
    assert half.withheld(object(), way, 5.0) == 0.0
