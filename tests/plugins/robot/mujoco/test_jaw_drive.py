"""The drive of the jaws on a model of plain numbers: speed, force, pauses and lost pressure."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.mujoco.machine.jaw_drive import JawDrive, jaw_inertia

# Each jaw: 1 kg 3 m from its pivot, and 1 kg·m² about its own centre: 10 kg·m².
LINK = SimpleNamespace(mass_kg=1.0, com_m=(3.0, 0.0, 7.0), inertia_diagonal=np.array([5, 5, 1.0]))
MACHINE = SimpleNamespace(
    jaw=SimpleNamespace(name="jaw", max_velocity=0.4),
    gripper=SimpleNamespace(tip_radius_m=1.5),
    links={"jaw_left": LINK, "jaw_right": LINK},
)
STEP_S = 0.01
SETTINGS = SimpleNamespace(grip_force_n=1000.0, jaw_stiffness=5.0)


def jaws(position_rad: float = 0.3) -> JawDrive:
    joint = SimpleNamespace(qpos=np.array([position_rad]), qvel=np.array([0.0]))
    model = SimpleNamespace(
        actuator=lambda name: SimpleNamespace(id=("arm", "jaw").index(name)),
        actuator_forcerange=np.zeros((2, 2)),
        opt=SimpleNamespace(timestep=STEP_S),
    )
    data = SimpleNamespace(
        joint=lambda name: joint, actuator_force=np.array([7.0, -50.0]), ctrl=np.zeros(2)
    )
    made = JawDrive(model, data, MACHINE, SETTINGS)
    made.joint, made.model, made.data = joint, model, data
    return made


def speed(drive: JawDrive) -> float:
    """Return the speed that the drive wants [rad/s]: its first torque from rest shows it."""
    drive.restore({**drive.keep(), "last_nm": 0.0, "last_rad_s": 0.0})
    drive.drive()
    assert drive.data.ctrl[0] == 0.0
    return float(drive.data.ctrl[1]) * STEP_S / (0.5 * jaw_inertia(MACHINE))


def commanded(drive: JawDrive) -> tuple[float, float, float]:
    kept = drive.keep()
    return kept["target_rad"], kept["torque_nm"], kept["share"]


def limits(drive: JawDrive) -> list[float]:
    assert not drive.model.actuator_forcerange[0].any()
    return drive.model.actuator_forcerange[1].tolist()


def test_jaws_begin_where_they_are_and_press_with_both_tips() -> None:
    drive = jaws()
    assert (drive.position_rad, drive.velocity_rad_s, drive.effort_nm) == (0.3, 0.0, -50.0)
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
    assert commanded(drive) == (0.0, 3000.0, 1.0)


def test_a_new_command_in_a_pause_is_what_goes_on() -> None:
    drive = jaws()
    drive.press(0.0, 1000.0)
    drive.hold()
    drive.press(0.9, 1000.0)
    drive.go_on()
    assert commanded(drive) == (0.9, 3000.0, 1.0)


def test_what_is_kept_is_taken_back() -> None:
    drive, other = jaws(), jaws(0.1)
    drive.press(0.2, 500.0)
    drive.weaken(0.5)
    assert commanded(drive) == (0.2, 1500.0, 0.5)
    other.restore(drive.keep())
    assert limits(other) == [-750.0, 750.0]
    assert speed(other) == pytest.approx(0.4)
    assert commanded(other) == (0.2, 1500.0, 0.5)
    assert other.keep() == {**drive.keep(), "last_nm": 400.0}  # 0.5·20 kg·m²·0.4 rad/s / 0.01 s
    other.weaken(1.0)  # the pressure is back, and what was commanded with it
    assert limits(other) == [-1500.0, 1500.0]


@pytest.mark.parametrize("load", [0.375, 0.5, 1.0, 20.0])
def test_jaws_come_to_their_speed_whatever_moves_with_them(load: float) -> None:
    """It is less than the jaws alone, as the arm yields, or far more, with a stone."""
    drive = jaws(-100.0)
    drive.press(100.0, 1000.0)
    inertia = load * 1.01 * jaw_inertia(MACHINE)
    for _ in range(2000):
        drive.drive()
        drive.joint.qvel[0] += drive.data.ctrl[1] * STEP_S / inertia
    assert drive.velocity_rad_s == pytest.approx(0.4, abs=1e-3)
    assert abs(drive.data.ctrl[1]) < 10.0


def test_jaws_that_are_held_back_press_with_all_of_their_force() -> None:
    drive = jaws()
    drive.press(0.0, 1000.0)
    for _ in range(8):  # 400 N·m a step
        drive.drive()
    assert drive.data.ctrl[1] == -3000.0
    drive.joint.qvel[0] = -0.2  # they give way: slower than wanted, and the force stays
    drive.drive()
    drive.drive()
    assert drive.data.ctrl[1] == -3000.0
    drive.joint.qvel[0] = -0.5  # faster than wanted
    drive.drive()
    assert drive.data.ctrl[1] > -3000.0
