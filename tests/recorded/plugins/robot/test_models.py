"""The compiled models of simulated worlds: masses, shapes, friction, drives and appearance."""

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.machine.machine import load_machine

MACHINE = load_machine("m545")
SMALL = {"stones": {"count": 2}, "terrain": {"half_size_m": 10}}
WORLDS = {
    "nominal": {"site": SMALL},
    "kind": {"scenario": "kind", "site": SMALL},
    "on_wheels": {"base": "on_wheels", "site": {**SMALL, "stones": {"count": 1}}},
}
PARTS = ("body_", "geom_", "jnt_", "dof_", "actuator_", "eq_", "site_", "tendon_", "pair_", "cam_")
# Where arrays lie in memory, and the order in which the compiler stores meshes, say nothing.
LEFT_OUT = ("adr", "bvh", "plugin", "user", "quat", "iquat", "aabb", "rbound", "name")


@pytest.mark.parametrize("name", WORLDS)
def test_a_model(recorded, name) -> None:
    robot = MujocoRobot(MujocoSettings(**WORLDS[name]), MACHINE, np.random.default_rng(5))
    robot.start()
    try:
        model = robot.world.model
        bodies = [model.body(i).name for i in range(model.nbody)]
        geoms = [model.geom(i).name for i in range(model.ngeom)]
        arrays = {
            field: np.array(getattr(model, field), dtype=float)
            for field in sorted(dir(model))
            if field.startswith(PARTS)
            and isinstance(getattr(model, field), np.ndarray)
            and not any(word in field for word in LEFT_OUT)
        }
        option = {
            field: float(getattr(model.opt, field))
            for field in ("timestep", "integrator", "cone", "solver", "iterations", "impratio")
        }
    finally:
        robot.close()
    assert isinstance(model, mujoco.MjModel)
    # Hulls and inertias of meshes are computed in single precision.
    recorded((bodies, geoms, option), relative=1e-6)
    places = arrays.pop("body_pos")
    recorded(arrays, relative=1e-4, absolute=1e-6)
    # Stones have settled on the ground: where to differs by millimetres between processors.
    recorded(places, relative=1e-4, absolute=5e-3)
