"""Kinematics against MuJoCo, and derivatives against differences, on every shipped machine."""

import mujoco
import numpy as np
import pytest

from executive.errors import ShapeError
from executive.geometry.rotation import log_so3
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.machine.mjcf import machine_spec

MACHINES = ("m545", "mini")


def random_arm(machine: Machine, rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(np.maximum(machine.lower, -7.0), np.minimum(machine.upper, 7.0))


@pytest.mark.parametrize("name", MACHINES)
def test_pinocchio_and_mujoco_agree_to_a_micrometre_over_a_thousand_configurations(
    name: str,
) -> None:
    machine = load_machine(name)
    kinematics, model = Kinematics(machine), machine_spec(machine).compile()
    data, rng = mujoco.MjData(model), np.random.default_rng(7)
    worst = 0.0
    for _ in range(1000):
        q, jaw_rad = random_arm(machine, rng), rng.uniform(0, machine.jaw.open_rad)
        for joint, value in zip(machine.arm_names, q, strict=True):
            data.joint(joint).qpos = value
        data.joint(machine.jaw.name).qpos = data.joint(machine.jaw.mirror_name).qpos = jaw_rad
        mujoco.mj_kinematics(model, data)
        frames = kinematics.frames(q, jaw_rad)
        for link in machine.links:
            body, T = data.body(link), frames[link]
            worst = max(
                worst,
                np.abs(body.xpos - T[:3, 3]).max(),
                np.abs(body.xmat.reshape(3, 3) - T[:3, :3]).max(),
            )
    assert worst < 1e-6


@pytest.mark.parametrize("name", MACHINES)
def test_the_jacobian_is_the_difference_quotient_of_the_gripper_pose(name: str) -> None:
    machine = load_machine(name)
    kinematics, q = Kinematics(machine), random_arm(load_machine(name), np.random.default_rng(3))
    J, step = kinematics.jacobian(q), 1e-6
    for i, e in enumerate(np.eye(len(q)) * step):
        T_a, T_b = kinematics.gripper(q - e), kinematics.gripper(q + e)
        velocity = (T_b[:3, 3] - T_a[:3, 3]) / (2 * step)
        turn = log_so3(T_b[:3, :3] @ T_a[:3, :3].T) / (2 * step)
        np.testing.assert_allclose(
            J[:, i], np.concatenate([velocity, turn]), atol=1e-6
        )  # second order in the step


def test_sensors_have_frames_and_the_gripper_looks_down_in_the_carrying_posture() -> None:
    machine = load_machine("m545")
    kinematics = Kinematics(machine)
    frames = kinematics.frames(machine.posture("carry"))
    T_cabin = frames[machine.cabin_link]
    for sensor in machine.sensors_of("lidar"):
        np.testing.assert_allclose(frames[sensor.name], T_cabin @ sensor.T_link_sensor, atol=1e-12)
    np.testing.assert_allclose(frames["gripper"][:3, 0], [0, 0, -1], atol=1e-9)


def test_the_two_lidars_spin_about_axes_at_right_angles() -> None:
    for name in MACHINES:
        vertical, horizontal = load_machine(name).sensors_of("lidar")
        assert vertical.T_link_sensor[:3, 2] @ horizontal.T_link_sensor[:3, 2] == pytest.approx(
            0, abs=1e-9
        )


def test_refuses_positions_of_another_length() -> None:
    with pytest.raises(ShapeError, match=r"expected \(7,\)"):
        Kinematics(load_machine("m545")).gripper(np.zeros(6))
