"""A drive without pressure in the simulated world stops the mission within three ticks."""

import pytest

from tests.faults.conftest import MISSION

WORLD = MISSION.replace(
    "robot: {plugin: kinematic, model: m545, noise: true}",
    "robot: {plugin: mujoco, model: m545, sensors: {azimuth_stride: 16},\n"
    "    site: {stones: {count: 1, volume_m3: [0.3, 0.5]}}}",
).replace("  joint_limits: stop\n", "  joint_limits: stop\n  pressure: stop\n")
LOOKS_S = 0.15


def test_a_sound_machine_on_cylinders_is_not_stopped(run):
    done = run(text=WORLD)
    assert done.report["outcome"] == "success"
    assert not done.of("condition_broken")


@pytest.mark.parametrize(("joint", "after_s"), [("J_BOOM", 3.0), ("J_TURN", 0.3)])
def test_a_drive_that_loses_its_pressure_is_named_before_the_arm_is_off_its_path(
    run, joint, after_s
):
    fault = f"{{actuator: {joint}, how: no_pressure, node: ScanSwing, after: {after_s} s}}"
    done = run(fault, text=WORLD)
    assert (done.report["outcome"], done.status) == ("fault", 3)
    told = f"watched condition 'pressure' failed: {joint} has no effort where its motion needs "
    assert done.report["reason"].startswith(told)
    late_s = done.first("condition_broken") - done.first("fault_injected")
    # The swing begins slowly: its drive needs an effort only when the cabin accelerates.
    assert 0.0 < late_s <= LOOKS_S + (0.0 if joint == "J_BOOM" else 1.0)


def test_efforts_that_read_zero_are_told_as_lost_pressure(run):
    done = run("{sensor: efforts, how: silent, node: ScanSwing, after: 3 s}", text=WORLD)
    assert done.status == 3
    assert "has no effort where its motion needs" in done.report["reason"]


def test_a_robot_that_measures_no_efforts_is_not_judged_by_them(run):
    done = run(text=MISSION.replace("tracking: {do: stop", "pressure: stop\n  tracking: {do: stop"))
    assert done.report["outcome"] == "success"
