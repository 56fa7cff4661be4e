"""The contact model: set on everything in a world, and with torsional friction."""

import mujoco
import numpy as np
import pytest
from executive_plugins.physics.contact import apply_contact
from executive_plugins.physics.contact_settings import ContactSettings
from executive_plugins.physics.scenario import Scenario, contact_of
from executive_plugins.physics.surface import Surface, uniform

from executive.machine.machine import load_machine


def world(surface: Surface) -> mujoco.MjSpec:
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
    apply_contact(spec, uniform(surface))
    return spec


def test_sets_friction_and_stiffness_of_all_surfaces_and_ties() -> None:
    model = world(Surface(friction=0.5, torsional_m=0.05)).compile()
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
    model = world(Surface(0.6, torsional_m=patch_m)).compile()
    data = mujoco.MjData(model)
    data.qvel[5] = 3.0  # about the vertical [rad/s]
    mujoco.mj_step(model, data, nstep=int(1.0 / model.opt.timestep))
    assert abs(data.qvel[5]) < 0.1 if is_stopped else data.qvel[5] > 2.5


def slab(name: str, spec: mujoco.MjSpec, x_m: float) -> mujoco.MjsBody:
    """Add a free box at rest on the plane: a stone."""
    body = spec.worldbody.add_body(name=name, pos=[x_m, 0.0, 0.1])
    body.add_freejoint()
    body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.3, 0.3, 0.1], density=2700.0)
    return body


@pytest.mark.parametrize("scenario", ["kind", "nominal", "wet", "harsh"])
def test_friction_is_that_of_the_pair_of_materials(scenario: Scenario) -> None:
    """A box on the ground, one on top of it, and a tool of steel on that one."""
    contact = contact_of(scenario, load_machine("m545").gripper)
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(name="ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9, 9, 1])
    slab("below", spec, 0.0)
    slab("above", spec, 0.0).pos = [0.0, 0.0, 0.299]
    tool = spec.worldbody.add_body(name="tool", pos=[0.0, 0.0, 0.445])
    tool.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, 1])
    tool.add_geom(name="tool", size=[0.05, 0, 0], density=7800.0)
    apply_contact(spec, contact)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    found = {}
    for one in data.contact:
        names = frozenset(model.geom(int(i)).name for i in one.geom)
        found[names] = (one.friction[0], one.friction[2], one.friction[3], one.solref[0])
    wanted = {
        frozenset(("ground", "below")): contact.soil,
        frozenset(("below", "above")): contact.stone,
        frozenset(("above", "tool")): contact.steel,
    }
    assert set(found) == set(wanted)
    for pair, surface in wanted.items():
        # MuJoCo keeps each coefficient above 1e-5; without rolling friction it is not used.
        expected = (surface.friction, surface.torsional_m, max(surface.rolling_m, 1e-5))
        assert found[pair] == pytest.approx((*expected, surface.time_constant_s))


def test_the_patch_is_that_of_the_narrowest_tooth() -> None:
    for name, half_m in (("m545", 0.08), ("mini", 0.06)):
        steel = contact_of("nominal", load_machine(name).gripper).steel
        assert steel.torsional_m == pytest.approx(2 / 3 * 0.4 * half_m)


def test_scenarios_become_harder_from_kind_to_harsh() -> None:
    gripper = load_machine("m545").gripper
    kind, nominal, wet, harsh = (
        contact_of(one, gripper) for one in ("kind", "nominal", "wet", "harsh")
    )
    for easy, hard in ((kind, nominal), (nominal, wet), (wet, harsh)):
        assert hard.steel.friction <= easy.steel.friction
        assert hard.steel.torsional_m < easy.steel.torsional_m
        assert hard.soil.friction <= easy.soil.friction


@pytest.mark.parametrize("scenario", ["nominal", "harsh"])
def test_a_ball_comes_to_rest_on_soil_only_with_rolling_friction(scenario: Scenario) -> None:
    """Pure rolling dissipates nothing in `kind`: the ball rolls on."""
    speeds = {}
    for name in ("kind", scenario):
        spec = mujoco.MjSpec()
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9, 9, 1])
        ball = spec.worldbody.add_body(name="ball", pos=[0.0, 0.0, 0.5])
        ball.add_freejoint()
        ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.5, 0, 0], density=2700.0)
        apply_contact(spec, contact_of(name, load_machine("m545").gripper))
        model = spec.compile()
        data = mujoco.MjData(model)
        data.qvel[0], data.qvel[4] = 0.5, 1.0  # rolls without sliding
        mujoco.mj_step(model, data, nstep=int(2.0 / model.opt.timestep))
        speeds[name] = float(np.linalg.norm(data.qvel[:3]))
    assert speeds["kind"] > 0.45
    assert speeds[scenario] < 1e-3


def test_given_numbers_replace_those_of_the_scenario_for_all_pairs() -> None:
    nominal = contact_of("nominal", load_machine("m545").gripper)
    assert ContactSettings().replaced(nominal) == nominal
    changed = ContactSettings(friction=0.2, impratio=10).replaced(nominal)
    assert {one.friction for one in (changed.steel, changed.soil, changed.stone)} == {0.2}
    assert changed.soil.rolling_m == nominal.soil.rolling_m
    assert changed.impratio == 10
