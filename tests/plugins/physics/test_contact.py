"""The contact model: set on everything in a world, and with torsional friction."""

import mujoco
import numpy as np
import pytest
from executive_plugins.physics.contact import apply_contact
from executive_plugins.physics.contact_settings import ContactSettings


def world(settings: ContactSettings) -> mujoco.MjSpec:
    """Return a ball on a plane, beside two hinged bodies that are tied to one another."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9, 9, 1])
    ball = spec.worldbody.add_body(name="ball", pos=[0.0, 0.0, 0.2])
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.2, 0, 0], density=2700.0)
    for name in ("left", "right"):
        body = spec.worldbody.add_body(name=name, pos=[3.0, 0.0, 3.0])
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0, 0], density=2700.0)
    tie = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, objtype=mujoco.mjtObj.mjOBJ_JOINT)
    tie.name1, tie.name2 = "left", "right"
    apply_contact(spec, settings)
    return spec


def test_sets_friction_and_stiffness_of_all_surfaces_and_ties() -> None:
    model = world(ContactSettings(friction=0.5, torsional_friction_m=0.05)).compile()
    np.testing.assert_allclose(model.geom_friction, np.tile([0.5, 0.05, 0.0], (4, 1)))
    np.testing.assert_allclose(model.geom_solref, np.tile([0.01, 1.0], (4, 1)))
    np.testing.assert_allclose(model.eq_solimp, [[0.99, 0.999, 0.001, 0.5, 2.0]])
    assert model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert model.opt.impratio == 100.0


@pytest.mark.parametrize(("patch_m", "is_stopped"), [(0.05, True), (0.0, False)])
def test_torsional_friction_stops_a_ball_that_spins_on_the_spot(
    patch_m: float, is_stopped: bool
) -> None:
    """Sliding friction alone has no moment about the normal at a single contact point."""
    model = world(ContactSettings(torsional_friction_m=patch_m)).compile()
    data = mujoco.MjData(model)
    data.qvel[5] = 3.0  # about the vertical [rad/s]
    mujoco.mj_step(model, data, nstep=int(1.0 / model.opt.timestep))
    assert abs(data.qvel[5]) < 0.1 if is_stopped else data.qvel[5] > 2.5
