"""Piles of generated stones that came to rest in MuJoCo, and what a survey sees of them."""

from dataclasses import dataclass
from types import ModuleType

import mujoco
import numpy as np
import open3d as o3d
from executive_plugins.physics.quarried_block import block
from executive_plugins.physics.rounded_stone import rounded_stone
from executive_plugins.physics.settling import come_to_rest
from perception.piles import Mesh, _labels

from executive.arrays import Float, Int
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose, transform

SPOT = np.array([5.0, 0.0])  # middle of the pile [m]
SPREAD_M = {"pile": 0.9, "touching": 2.2}  # radius within which stones are released
LAYERS = {"pile": 4, "touching": 12}  # stones released at one height
RAYS = 220_000
_VIEWS = 2000  # points of a stone that are looked at for how much of it is visible


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """A pile, and a cloud of it.

    Attributes:
        points: [m], shape (N, 3).
        labels: Number of the stone that each point is of, from 1; 0: ground, shape (N,).
        visible: Share of each stone's surface that can be seen from above or obliquely.
    """

    points: Float
    labels: Int
    visible: Float


def settled(kind: str, count: int, seed: int, scenes: ModuleType) -> Settled:
    """Drop so many stones, blocks and rounded ones by turns, let them rest, and survey them."""
    rng = np.random.default_rng(seed)
    stones = _at_rest(kind, count, rng)
    site, _ = scenes._world(rng, 0, 0.0, 1.0, scenes._stone)
    for stone in stones:
        scenes._add(site, stone.vertices, stone.faces)
    swept = scenes._swept(site, rng, RAYS)
    flown = scenes._surveyed(site, rng, RAYS // 2, np.array([*SPOT, 0.3]))
    points = np.vstack([swept, flown])
    near = np.linalg.norm(points[:, :2] - SPOT, axis=1) < 4.5
    points = scenes._thin(points[near], 0.03)
    return Settled(
        points, _labels(site, points), np.array([_visible(site, s, rng) for s in stones])
    )


def _at_rest(kind: str, count: int, rng: np.random.Generator) -> list[Mesh]:
    shapes = [
        hull_mesh((rounded_stone, block)[k % 2](rng.uniform(0.15, 0.5), rng)) for k in range(count)
    ]
    spec = mujoco.MjSpec()
    spec.option.timestep = 0.004
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[20, 20, 1])
    for k, (corners, faces) in enumerate(shapes):
        mesh = spec.add_mesh(name=f"stone_{k}")
        mesh.uservert, mesh.userface = corners.ravel(), faces.ravel()
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_EXACT
        angle, radius = rng.uniform(-np.pi, np.pi), SPREAD_M[kind] * np.sqrt(rng.uniform())
        quaternion = rng.normal(size=4)
        height = 1.0 + 1.1 * (k // LAYERS[kind]) + (1.1 * k if kind == "touching" else 0.0)
        body = spec.worldbody.add_body(
            pos=[*(SPOT + radius * np.array([np.cos(angle), np.sin(angle)])), height],
            quat=quaternion / np.linalg.norm(quaternion),
        )
        body.add_freejoint()
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name, density=2700)
    model = spec.compile()
    data = mujoco.MjData(model)
    come_to_rest(model, data, 2.0, 12.0)
    found = []
    for k in range(count):
        T = pose(data.geom_xmat[k + 1].reshape(3, 3), data.geom_xpos[k + 1])
        first, number = model.mesh_vertadr[k], model.mesh_vertnum[k]
        first_face, faces_number = model.mesh_faceadr[k], model.mesh_facenum[k]
        vertices = transform(T, model.mesh_vert[first : first + number].astype(float))
        faces = model.mesh_face[first_face : first_face + faces_number].astype(np.int64)
        found.append(Mesh(vertices, faces))
    return found


def _visible(site: o3d.t.geometry.RaycastingScene, stone: Mesh, rng: np.random.Generator) -> float:
    """Return the share of a stone's surface from which one of five directions upward is free."""
    a, b, c = (stone.vertices[stone.faces[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    drawn = rng.choice(len(areas), _VIEWS, p=areas / areas.sum())
    shares = rng.dirichlet([1, 1, 1], _VIEWS)
    points = np.einsum("ij,ijk->ik", shares, stone.vertices[stone.faces[drawn]])
    outward = np.cross(b - a, c - a)[drawn]
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    outward *= np.sign(((points - stone.vertices.mean(axis=0)) * outward).sum(axis=1))[:, None]
    is_free = np.zeros(_VIEWS, dtype=bool)
    for way in ([0, 0, 1.0], [0.7, 0, 0.7], [-0.7, 0, 0.7], [0, 0.7, 0.7], [0, -0.7, 0.7]):
        origins = points + 0.003 * outward
        rays = np.column_stack([origins, np.tile(way, (_VIEWS, 1))]).astype(np.float32)
        ranges = site.cast_rays(o3d.core.Tensor(rays))["t_hit"].numpy()
        is_free |= np.isinf(ranges) & (outward @ np.array(way) > 0.1)
    return float(is_free.mean())
