"""Encoders measure the joints by name, each with the noise of its kind."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.mujoco.sensors.encoders import JointEncoders

from executive.machine.machine import load_machine

M545 = load_machine("m545")
NAMES = M545.joint_names
N = len(NAMES)


def encoders(noise: dict[str, float]) -> tuple[JointEncoders, SimpleNamespace]:
    """Return encoders of a world whose joints are numbered backwards, and its state."""
    sheet = next(iter(M545.sensors_of("encoders"))).model_copy(update=noise)

    def joint(name: str) -> SimpleNamespace:
        place = N - 1 - NAMES.index(name)
        return SimpleNamespace(qposadr=[place + 1], dofadr=[place])

    data = SimpleNamespace(
        qpos=np.append(99.0, np.arange(N)[::-1]),
        qvel=10.0 + np.arange(N)[::-1],
        qfrc_actuator=1000.0 + np.arange(N)[::-1],
    )
    model = SimpleNamespace(joint=joint)
    return JointEncoders(sheet, M545, model, np.random.default_rng(0)), data


NONE = {"length_noise_m": 0, "angle_noise_rad": 0, "velocity_noise": 0, "effort_noise": 0}


def test_without_noise_each_joint_has_its_own_values() -> None:
    one, data = encoders(NONE)
    sample = one.sample(1.5, data)
    assert (sample.stamp_s, sample.names) == (1.5, NAMES)
    np.testing.assert_array_equal(sample.position, np.arange(N))
    np.testing.assert_array_equal(sample.velocity, 10.0 + np.arange(N))
    np.testing.assert_array_equal(sample.effort, 1000.0 + np.arange(N))


def test_noise_is_by_the_kind_of_joint_and_the_largest_effort() -> None:
    one, data = encoders(
        {"length_noise_m": 0.5, "angle_noise_rad": 2.0, "velocity_noise": 0.1, "effort_noise": 0.01}
    )
    samples = [one.sample(0.0, data) for _ in range(4000)]
    position, velocity, effort = (
        np.std([getattr(sample, name) for sample in samples], axis=0)
        for name in ("position", "velocity", "effort")
    )
    kinds = [joint.kind for joint in M545.joints] + ["revolute"]
    expected = [0.5 if kind == "prismatic" else 2.0 for kind in kinds]
    assert position == pytest.approx(expected, rel=0.06)
    assert velocity == pytest.approx(np.full(N, 0.1), rel=0.06)
    limits = [joint.max_effort for joint in (*M545.joints, M545.jaw)]
    assert effort == pytest.approx(0.01 * np.array(limits), rel=0.06)
