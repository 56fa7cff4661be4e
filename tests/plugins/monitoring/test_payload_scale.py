"""Weighing, against the energy that it takes to lift."""

import numpy as np
import pytest
from executive_plugins.monitoring.payload_scale import PayloadScale

from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.joints import JointSample

G = 9.81
POSTURES = np.array([0.4, 0.6, 0.2, 0.8, -1.0, 0.2, 1.0])


def potential_energy(machine: Machine, q: np.ndarray, jaw_rad: float, payload_kg: float) -> float:
    frames = Kinematics(machine).frames(q, jaw_rad)
    links = sum(
        link.mass_kg * transform(frames[name], np.array(link.com_m))[2]
        for name, link in machine.links.items()
    )
    return G * (links + payload_kg * transform(frames["gripper"], machine.gripper.grasp_centre)[2])


def efforts(machine: Machine, q: np.ndarray, jaw_rad: float, payload_kg: float) -> np.ndarray:
    """Return the gradient of the potential energy by central differences: what holds the machine
    still.
    """
    steps = 1e-5 * np.eye(len(q))
    return (
        np.array(
            [
                potential_energy(machine, q + s, jaw_rad, payload_kg)
                - potential_energy(machine, q - s, jaw_rad, payload_kg)
                for s in steps
            ]
        )
        / 2e-5
    )


def sample(
    machine: Machine, q: np.ndarray, jaw_rad: float, effort: np.ndarray, speed: float = 0.0
) -> JointSample:
    n = len(q) + 1
    return JointSample(
        0.0, machine.joint_names, np.append(q, jaw_rad), np.full(n, speed), np.append(effort, 0.0)
    )


def transform_velocity(rate: np.ndarray, point: tuple) -> np.ndarray:
    """Return the velocity of a point of a link, from the rate of the link's pose."""
    return rate[:3, :3] @ np.array(point) + rate[:3, 3]


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_the_empty_machine_needs_the_gradient_of_its_energy(model: str) -> None:
    machine = load_machine(model)
    q = machine.posture("carry") + 0.05
    expected = efforts(machine, q, 0.3, 0.0)
    np.testing.assert_allclose(
        PayloadScale(machine).empty_effort(np.append(q, 0.3)), expected, rtol=1e-5, atol=0.5
    )


@pytest.mark.parametrize("payload_kg", [0.0, 400.0, 2500.0])
def test_weighs_what_hangs_in_the_gripper(payload_kg: float) -> None:
    machine = load_machine("m545")
    effort = efforts(machine, POSTURES, 0.5, payload_kg)
    assert PayloadScale(machine).weigh(sample(machine, POSTURES, 0.5, effort)) == pytest.approx(
        payload_kg, abs=1.0
    )


def test_an_arm_that_moves_needs_efforts_that_are_no_weight() -> None:
    machine = load_machine("m545")
    scale, q = PayloadScale(machine), np.append(machine.posture("carry"), 0.3)
    assert machine.hydraulics is not None
    boom = np.arange(7) == 1
    lever = scale.lever(q[:-1])
    rubbed = machine.hydraulics.friction * machine.joints[1].max_effort
    assert scale.moving_kg(q, np.zeros(7), np.zeros(7, dtype=bool)) == 0.0
    friction_kg = scale.moving_kg(q, np.zeros(7), boom)
    assert friction_kg == pytest.approx(rubbed * abs(lever[1]) / (lever @ lever))
    # What accelerates the boom by a radian per second squared, by the kinetic energy at one.
    kinematics = Kinematics(machine)
    step = 1e-6
    frames = [kinematics.frames(q[:-1] + d * step * boom, 0.3) for d in (-1, 1)]
    moved = {name: (frames[1][name] - frames[0][name]) / (2 * step) for name in machine.links}
    points = sum(
        link.mass_kg * float((transform_velocity(moved[name], link.com_m) ** 2).sum())
        for name, link in machine.links.items()
    )
    shaken_kg = scale.moving_kg(q, boom.astype(float), np.zeros(7, dtype=bool))
    assert shaken_kg > 0.7 * points * abs(lever[1]) / (lever @ lever)


def test_tells_the_vertical_speed_of_the_stone() -> None:
    machine = load_machine("m545")
    scale, kinematics = PayloadScale(machine), Kinematics(machine)
    heights = [
        transform(kinematics.gripper(POSTURES + step), machine.gripper.grasp_centre)[2]
        for step in (-1e-6, 1e-6)
    ]
    measured = scale.rise_m_s(sample(machine, POSTURES, 0.5, np.zeros(7), speed=0.1))
    assert measured == pytest.approx(0.1 * (heights[1] - heights[0]) / 2e-6, rel=1e-5)
