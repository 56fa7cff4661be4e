"""Scenes for the figures of perception: single stones and stones in piles."""

import importlib.util
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
import open3d as o3d
from scipy.spatial import ConvexHull

from executive.arrays import Float, Int
from executive.geometry.rotation import exp_so3

TESTS = Path(__file__).parents[2]
SCANNED = TESTS.parents[1] / "shared" / "data" / "stones"
CLOUDS = TESTS.parents[1] / "shared" / "data" / "clouds"
PILES = (2, 2, 3)
LIDAR_RAYS, DRONE_RAYS = 200_000, 90_000  # 108,000 points in the map, 75,000 in the survey


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Corners [m] and triangles of a stone."""

    vertices: Float
    faces: Int

    def moved(self, shift: Float) -> "Mesh":
        return Mesh(self.vertices + shift, self.faces)


@dataclass(frozen=True, slots=True, eq=False)
class Piles:
    """Seven stones in three piles, and two clouds of them.

    Attributes:
        gap_m: Distance between surfaces of neighbours in a pile.
        clouds: What the lidars and the drone see, each (points, number of the stone that each point
            is of, 0: ground).
    """

    gap_m: float
    clouds: dict[str, tuple[Float, Int]]


def load_scenes() -> ModuleType:
    """Return the module that draws scenes for the tests of registration."""
    path = TESTS / "plugins" / "registration" / "conftest.py"
    spec = importlib.util.spec_from_file_location("registration_scenes", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def _convex(rng: np.random.Generator, scenes: ModuleType) -> Mesh:
    corners = scenes._stone(rng)
    return Mesh(corners, ConvexHull(corners).simplices)


def _scanned(rng: np.random.Generator, scenes: ModuleType) -> Mesh:
    """Return a natural stone, 0.5 to 1 m³, lying on its flat side."""
    files = sorted(SCANNED.glob("*.obj"))
    mesh = o3d.io.read_triangle_mesh(str(files[rng.integers(len(files))]))
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    edges = vertices[faces]
    volume = abs(np.einsum("ij,ij->i", edges[:, 0], np.cross(edges[:, 1], edges[:, 2])).sum()) / 6
    centred = (vertices - vertices.mean(axis=0)) * (rng.uniform(0.5, 1.0) / volume) ** (1 / 3)
    axes = np.linalg.eigh(centred.T @ centred)[1][:, ::-1]  # longest first, shortest up
    lying = centred @ (axes * [1, 1, np.linalg.det(axes)])
    return Mesh(lying @ exp_so3(np.array([0, 0, rng.uniform(-np.pi, np.pi)])).T, faces)


SHAPES = {"convex": _convex, "scanned": _scanned}


def _rays(mesh: Mesh) -> o3d.t.geometry.RaycastingScene:
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        *(
            o3d.core.Tensor(x)
            for x in (mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))
        )
    )
    return scene


def gap_between(a: Mesh, b: Mesh) -> float:
    """Return the distance of two surfaces [m], negative if they cut each other; accurate to a few
    millimetres.
    """
    rng, found = np.random.default_rng(0), []
    for one, other in ((a, b), (b, a)):
        shares = rng.dirichlet([1, 1, 1], 1500)
        inner = np.einsum(
            "ij,ijk->ik",
            shares,
            other.vertices[other.faces[rng.integers(len(other.faces), size=1500)]],
        )
        points = np.vstack([inner, other.vertices]).astype(np.float32)
        found.append(
            float(_rays(one).compute_signed_distance(o3d.core.Tensor(points)).numpy().min())
        )
    return min(found)


def _beside(stone: Mesh, placed: Sequence[Mesh], gap_m: float, rng: np.random.Generator) -> Mesh:
    """Push a stone sideways towards the last one placed, up to the given gap to its nearest
    neighbour.
    """
    while True:
        angle = rng.uniform(-np.pi, np.pi)
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        foot = placed[-1].vertices.mean(axis=0) * [1, 1, 0]
        near, far = 0.0, 3.0
        for _ in range(11):
            middle = (near + far) / 2
            apart = min(gap_between(stone.moved(foot + middle * way), other) for other in placed)
            near, far = (middle, far) if apart < gap_m else (near, middle)
        moved = stone.moved(foot + far * way)
        if abs(min(gap_between(moved, other) for other in placed) - gap_m) < 0.01:
            return moved


def piles_of(seed: int, gap_m: tuple[float, float], shape: str, scenes: ModuleType) -> Piles:
    """Return the scene of a seed, its gap drawn between two [m], with stones of one of `SHAPES`."""
    rng = np.random.default_rng(seed)
    gap = float(rng.uniform(*gap_m))
    site, _ = scenes._world(rng, 0, 0.0, 1.0, scenes._stone)
    spots: list[Float] = []
    while len(spots) < len(PILES):
        angle, distance = rng.uniform(-1.9, 1.9), rng.uniform(3.5, 6.5)
        spot = distance * np.array([np.cos(angle), np.sin(angle), 0.0])
        if all(np.linalg.norm(spot - other) > 4.0 for other in spots):
            spots.append(spot)
    placed: list[Mesh] = []
    for count, spot in zip(PILES, spots, strict=True):
        for number in range(count):
            stone = SHAPES[shape](rng, scenes)
            stone = stone.moved(
                -stone.vertices.mean(axis=0) * [1, 1, 0] - [0, 0, stone.vertices[:, 2].min() + 0.05]
            )
            placed.append(_beside(stone, placed, gap, rng) if number else stone.moved(spot))
    for stone in placed:
        scenes._add(site, stone.vertices, stone.faces)
    middle = np.array(
        [*np.mean([stone.vertices.mean(axis=0)[:2] for stone in placed], axis=0), 0.3]
    )
    seen = {
        "lidar": scenes._swept(site, rng, LIDAR_RAYS),
        "drone": scenes._surveyed(site, rng, DRONE_RAYS, middle),
    }
    return Piles(gap, {name: (points, _labels(site, points)) for name, points in seen.items()})


def _labels(site: o3d.t.geometry.RaycastingScene, points: Float) -> Int:
    nearest = site.compute_closest_points(o3d.core.Tensor(points.astype(np.float32)))
    return np.asarray(nearest["geometry_ids"].numpy().astype(np.int64))
