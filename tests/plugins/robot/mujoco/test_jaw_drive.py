"""The drive of the jaws on a model of plain numbers: speed, force, pauses and lost pressure."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.mujoco.machine.jaw_drive import JawDrive

MACHINE = SimpleNamespace(
    jaw=SimpleNamespace(name="jaw", max_velocity=0.4), gripper=SimpleNamespace(tip_radius_m=1.5)
)
SETTINGS = SimpleNamespace(grip_force_n=1000.0, jaw_stiffness=5.0)


def jaws(position_rad: float = 0.3) -> JawDrive:
    joint = SimpleNamespace(qpos=np.array([position_rad]), qvel=np.array([0.1]))
    model = SimpleNamespace(
        actuator=lambda name: SimpleNamespace(id=("arm", "jaw").index(name)),
        actuator_forcerange=np.zeros((2, 2)),
    )
    data = SimpleNamespace(
        joint=lambda name: joint, actuator_force=np.array([7.0, -50.0]), ctrl=np.zeros(2)
    )
    made = JawDrive(model, data, MACHINE, SETTINGS)
    made.joint, made.model, made.data = joint, model, data
    return made


def speed(drive: JawDrive) -> float:
    drive.drive()
    assert drive.data.ctrl[0] == 0.0
    return float(drive.data.ctrl[1])


def limits(drive: JawDrive) -> list[float]:
    assert not drive.model.actuator_forcerange[0].any()
    return drive.model.actuator_forcerange[1].tolist()


def test_jaws_begin_where_they_are_and_press_with_both_tips() -> None:
    drive = jaws()
    assert (drive.position_rad, drive.velocity_rad_s, drive.effort_nm) == (0.3, 0.1, -50.0)
    assert speed(drive) == 0.0
    assert limits(drive) == [-3000.0, 3000.0]  # 1 kN at 1.5 m, twice


@pytest.mark.parametrize(
    ("target_rad", "expected"), [(0.35, 0.25), (0.25, -0.25), (0.9, 0.4), (0.0, -0.4)]
)
def test_the_speed_falls_with_the_distance(target_rad: float, expected: float) -> None:
    drive = jaws()
    drive.press(target_rad, 200.0)
    assert speed(drive) == pytest.approx(expected)
    assert limits(drive) == [-600.0, 600.0]


def test_lost_pressure_is_a_share_of_whatever_is_commanded() -> None:
    drive = jaws()
    drive.weaken(0.25)
    assert limits(drive) == [-750.0, 750.0]
    drive.press(0.0, 200.0)
    assert limits(drive) == [-150.0, 150.0]
    drive.weaken(1.0)
    assert limits(drive) == [-600.0, 600.0]


@pytest.mark.parametrize(("effort_nm", "holds"), [(-1499.0, True), (-1501.0, False), (1501, False)])
def test_free_jaws_hold_in_a_pause_and_go_on_after_it(effort_nm: float, holds: bool) -> None:
    """Those that press with more than half of their force keep pressing."""
    drive = jaws()
    drive.press(0.0, 1000.0)
    drive.data.actuator_force[1] = effort_nm
    drive.hold()
    assert speed(drive) == pytest.approx(0.0 if holds else -0.4)
    drive.joint.qpos[0] = 0.28
    drive.hold()  # a second one changes nothing
    assert speed(drive) == pytest.approx(0.1 if holds else -0.4)
    drive.go_on()
    assert speed(drive) == pytest.approx(-0.4)
    drive.go_on()
    assert drive.keep() == (0.0, 3000.0, 1.0)


def test_a_new_command_in_a_pause_is_what_goes_on() -> None:
    drive = jaws()
    drive.press(0.0, 1000.0)
    drive.hold()
    drive.press(0.9, 1000.0)
    drive.go_on()
    assert drive.keep() == (0.9, 3000.0, 1.0)


def test_what_is_kept_is_taken_back() -> None:
    drive, other = jaws(), jaws(0.1)
    drive.press(0.2, 500.0)
    drive.weaken(0.5)
    assert drive.keep() == (0.2, 1500.0, 0.5)
    other.restore(drive.keep())
    assert limits(other) == [-750.0, 750.0]
    assert speed(other) == pytest.approx(0.4)
    assert other.keep() == (0.2, 1500.0, 0.5)
    other.weaken(1.0)  # the pressure is back, and what was commanded with it
    assert limits(other) == [-1500.0, 1500.0]
