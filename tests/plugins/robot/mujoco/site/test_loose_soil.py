"""Loose soil: teeth pass it, stones stand on it."""

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.site.terrain import FIRM, TERRAIN, Terrain, let_dig

LOOSE_M = 0.15


def bottoms_m(loose_m: float) -> dict[str, float]:
    """Return how high a tooth and a stone come to rest that are let go above level ground [m]."""
    spec = mujoco.MjSpec()
    spec.option.timestep = 0.0025
    edge = np.linspace(-2.0, 2.0, 21)
    Terrain(edge, np.zeros((21, 21)), loose_m).add_to(spec)
    for name, x in (("tooth", -0.7), ("stone", 0.7)):
        body = spec.worldbody.add_body(name=name, pos=[x, 0.0, 0.3])
        body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.1], mass=100.0)
    let_dig(spec.body("tooth"))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=800)
    return {name: float(data.body(name).xpos[2]) - 0.1 for name in ("tooth", "stone")}


def test_teeth_pass_loose_soil_and_stones_stand_on_it() -> None:
    rests = bottoms_m(LOOSE_M)
    assert rests["tooth"] == pytest.approx(-LOOSE_M, abs=0.01)
    assert rests["stone"] == pytest.approx(0.0, abs=0.01)


def test_teeth_stand_on_rock() -> None:
    rests = bottoms_m(0.0)
    assert rests["tooth"] == pytest.approx(0.0, abs=0.01)
    assert rests["stone"] == pytest.approx(0.0, abs=0.01)


def test_teeth_touch_stones_in_loose_soil() -> None:
    spec = mujoco.MjSpec()
    Terrain(np.linspace(-1.0, 1.0, 11), np.zeros((11, 11)), LOOSE_M).add_to(spec)
    for name, z in (("stone", 0.1), ("tooth", 0.25)):
        body = spec.worldbody.add_body(name=name, pos=[0.0, 0.0, z])
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.1], mass=1.0)
    let_dig(spec.body("tooth"))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    pairs = {
        frozenset(model.body(int(model.geom_bodyid[geom])).name or TERRAIN for geom in pair)
        for pair in data.contact.geom
    }
    assert frozenset(("tooth", "stone")) in pairs
    assert model.geom(FIRM).id not in set(data.contact.geom.ravel())
