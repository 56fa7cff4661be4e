"""Settling: velocities decay with the time constant, and rest is told from motion."""

import mujoco
import numpy as np
import pytest
from executive_plugins.physics.settling import come_to_rest


def spinning() -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return a wheel without load that turns at 1 rad/s."""
    spec = mujoco.MjSpec()
    wheel = spec.worldbody.add_body(name="wheel")
    wheel.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    wheel.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0, 0])
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    return model, data


def test_velocities_decay_within_half_a_second() -> None:
    model, data = spinning()
    assert not come_to_rest(model, data, 1.0, 1.0)
    assert data.qvel[0] == pytest.approx(np.exp(-1.0 / 0.5), rel=0.02)


def test_rest_is_reported_once_the_wheel_turns_slower_than_a_milliradian_per_second() -> None:
    model, data = spinning()
    assert come_to_rest(model, data, 0.5, 9.0)
    assert data.time == pytest.approx(0.5 * np.log(1000.0), rel=0.02)
    assert abs(data.qvel[0]) <= 1e-3


def test_a_body_at_rest_is_watched_for_the_least_time() -> None:
    model, data = spinning()
    data.qvel[0] = 0.0
    assert come_to_rest(model, data, 0.5, 9.0)
    assert data.time == pytest.approx(0.5, abs=2 * model.opt.timestep)
