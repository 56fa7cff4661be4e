"""Stones that are released on rough ground, and how far they still move afterwards.

Stones of the site's generator, and scans of a folder, are released just above the ground in any
orientation, as from the jaws, and left alone for 5 s. Then the largest distance that any corner of
a stone moves within 5 s is measured. MuJoCo's sleep is off, and nothing is damped by hand.
"""

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.physics.rounded_stone import rounded_stone
from executive_plugins.physics.scenario import Scenario, contact_of
from executive_plugins.robot.mujoco.physics import apply_physics
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import StoneSettings, TerrainSettings
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.stones import make_stones
from executive_plugins.robot.mujoco.site.terrain import Terrain, make_terrain

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_quaternion
from executive.machine.machine import load_machine

DENSITY_KG_M3 = 2700.0
RELEASED_M = 0.02  # height of the lowest point above the ground
WAIT_S, WATCH_S = 5.0, 5.0
STILL_M = 1e-3
GRID_M = 4.0  # distance of the stones from one another
LOOK_S = 0.05  # period of the looks while the stones are watched
GRIPPER = load_machine("m545").gripper


def generated(number: int, seed: int) -> tuple[StoneModel, ...]:
    """Draw quarried blocks and as many rounded stones."""
    rng = np.random.default_rng(seed)
    blocks = make_stones(StoneSettings(count=(number + 1) // 2), 3000.0, rng)
    rounded = (hull_mesh(rounded_stone(rng.uniform(0.5, 1.0), rng)) for _ in range(number // 2))
    return (
        *blocks,
        *(StoneModel.from_skin(f"round_{i}", one, DENSITY_KG_M3) for i, one in enumerate(rounded)),
    )


def scanned(number: int, folder: Path, scale: float, seed: int) -> tuple[StoneModel, ...]:
    """Draw scans of a folder."""
    files = mesh_files(folder)
    drawn = np.random.default_rng(seed).permutation(len(files))[:number]
    return tuple(
        StoneModel.from_skin(f"scan_{i}", read_skin(files[i], scale), DENSITY_KG_M3) for i in drawn
    )


def motions_m(
    stones: tuple[StoneModel, ...], scenario: Scenario, rng: np.random.Generator
) -> Iterator[float]:
    """Release the stones, a few at a time, and yield how far each moves afterwards [m]."""
    terrain = make_terrain(TerrainSettings(pad_radius_m=0.0), rng)
    places = [GRID_M * np.array([x, y]) for x in (-2, -1, 0, 1, 2) for y in (-2, -1, 0, 1, 2)]
    for first in range(0, len(stones), len(places)):
        yield from _released(stones[first : first + len(places)], places, terrain, scenario, rng)


def _released(
    stones: tuple[StoneModel, ...],
    places: list[Float],
    terrain: Terrain,
    scenario: Scenario,
    rng: np.random.Generator,
) -> list[float]:
    spec = mujoco.MjSpec()
    terrain.add_to(spec)
    for stone, place in zip(stones, places, strict=False):
        quaternion = rng.normal(size=4)
        R = from_quaternion(quaternion / np.linalg.norm(quaternion))
        corners = stone.hull @ R.T
        ground_m = terrain.height_at(corners[:, :2] + place)
        lift_m = float((ground_m - corners[:, 2]).max()) + RELEASED_M
        stone.add_to(spec, pose(R, np.array([*place, lift_m])))
    apply_physics(spec, PhysicsSettings(), contact_of(scenario, GRIPPER))
    spec.option.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    model = spec.compile()
    data = mujoco.MjData(model)
    step_s = float(model.opt.timestep)
    mujoco.mj_step(model, data, nstep=round(WAIT_S / step_s))
    begun = _corners(stones, data)
    moved = np.zeros(len(stones))
    for _ in range(round(WATCH_S / LOOK_S)):
        mujoco.mj_step(model, data, nstep=round(LOOK_S / step_s))
        now = _corners(stones, data)
        far = [float(np.linalg.norm(a - b, axis=1).max()) for a, b in zip(now, begun, strict=True)]
        moved = np.maximum(moved, far)
    return [float(one) for one in moved]


def _corners(stones: tuple[StoneModel, ...], data: mujoco.MjData) -> list[Float]:
    poses = [pose(from_quaternion(q[3:]), q[:3]) for q in data.qpos.reshape(-1, 7)]
    return [transform(T, stone.hull) for T, stone in zip(poses, stones, strict=True)]


def figures(name: str, stones: tuple[StoneModel, ...], scenario: Scenario, seed: int) -> Figure:
    """Return the share of stones at rest, with the largest motion."""
    moved = list(motions_m(stones, scenario, np.random.default_rng(seed)))
    resting = sum(one < STILL_M for one in moved)
    told = f"{resting} of {len(moved)}, largest motion {1e3 * max(moved):.2f} mm"
    what = f"{scenario}: {name} at rest 5 s after the release [%]"
    if scenario == "kind":
        return Figure(what, told)
    return held(what, 100.0 * resting / len(moved), Bound(100.0, is_least=True), told)
