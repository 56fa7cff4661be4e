"""Scenes whose true registration is known: stones on rough ground, seen by the machine's lidars
and by a drone.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import open3d as o3d
import pytest
from executive_plugins.physics.quarried_block import block
from executive_plugins.physics.rounded_stone import rounded_stone
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.clouds.reader import read_points
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.messages.cloud import Cloud

SHARED = Path(__file__).parents[4] / "shared" / "data" / "clouds"
StoneMaker = Callable[[np.random.Generator], Float]


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A map and a survey of one site.

    The survey has a frame and a scale of its own: p_target = c + (T p_source − c) / stretch.

    Attributes:
        target: The lidars' map.
        source: The drone's survey.
        T_target_source: T above, shape (4, 4).
        stretch: Factor by which the survey is too large.
        centre: c, the middle of the site in the map [m], shape (3,).
        stones: Centroids of the stones in the map [m], shape (K, 3).
        is_same_site: Whether the survey shows the site of the map; if not, it must be refused.
    """

    target: Cloud
    source: Cloud
    T_target_source: Float
    stretch: float
    centre: Float
    stones: Float
    is_same_site: bool = True

    def errors(self, apply: Callable[[Float], Float]) -> tuple[float, float]:
        """Return the errors of a motion from source to target: the largest over the site, and that
        at its centre [m].
        """
        corners = self.centre + np.array([[x, y, 0.0] for x in (-4, 0, 4) for y in (-4, 0, 4)])
        in_source = transform(
            inverse(self.T_target_source), self.centre + (corners - self.centre) * self.stretch
        )
        distances = np.linalg.norm(apply(in_source) - corners, axis=1)
        return float(distances.max()), float(distances[4])


def _stone(rng: np.random.Generator) -> Float:
    """Return corners of a convex stone, of 0.5 to 1 m³, about the origin."""
    points = rng.normal(size=(26, 3))
    points *= (1 / np.linalg.norm(points, axis=1) * rng.uniform(0.85, 1.1, 26))[:, None]
    points *= np.array(
        [1.0, np.clip(rng.normal(0.76, 0.13), 0.5, 1), np.clip(rng.normal(0.55, 0.14), 0.35, 1)]
    )
    points *= (rng.uniform(0.5, 1.0) / ConvexHull(points).volume) ** (1 / 3)
    turned = points @ exp_so3(rng.normal(0, 0.25, 3)).T
    return np.asarray(turned @ exp_so3(np.array([0, 0, rng.uniform(-np.pi, np.pi)])).T)


def _quarried(rng: np.random.Generator) -> Float:
    """Return corners of a block with flat faces, of 0.5 to 1 m³, turned at random."""
    return _turned(block(rng.uniform(0.5, 1.0), rng), rng)


def _rounded(rng: np.random.Generator) -> Float:
    """Return corners of a stone without edges, of 0.5 to 1 m³, turned at random."""
    return _turned(rounded_stone(rng.uniform(0.5, 1.0), rng), rng)


def _turned(corners: Float, rng: np.random.Generator) -> Float:
    tilted = corners @ exp_so3(rng.normal(0, 0.25, 3)).T
    return np.asarray(tilted @ exp_so3(np.array([0, 0, rng.uniform(-np.pi, np.pi)])).T)


def _world(
    rng: np.random.Generator, count: int, near_m: float, far_m: float, stone: StoneMaker
) -> tuple[o3d.t.geometry.RaycastingScene, Float]:
    """Return a site about the origin: waves of 4 cm, ruts of 1 cm, and stones between two distances
    ahead and to the sides.
    """
    scene, centres = o3d.t.geometry.RaycastingScene(), []
    phases, directions = rng.uniform(0, 6.28, 4), rng.uniform(-1.5, 1.5, (4, 2))

    def ground(xy: Float) -> Float:
        return np.asarray(0.03 * np.sin(xy @ directions.T + phases).sum(axis=1))

    axis = np.linspace(-12, 12, 121)
    xy = np.array(np.meshgrid(axis, axis, indexing="ij")).reshape(2, -1).T
    heights = ground(xy) + rng.normal(0, 0.01, len(xy))
    corner = (np.arange(120)[:, None] * 121 + np.arange(120)).ravel()
    faces = (
        np.vstack(
            [
                corner + np.array([[0], [121], [122]]),
            ]
        ).T,
        (corner + np.array([[0], [122], [1]])).T,
    )
    _add(scene, np.column_stack([xy, heights]), np.vstack(faces))
    while len(centres) < count:
        angle, distance = rng.uniform(-1.9, 1.9), rng.uniform(near_m, far_m)
        spot = distance * np.array([np.cos(angle), np.sin(angle)])
        if all(np.linalg.norm(spot - c[:2]) > 1.9 for c in centres):
            corners = stone(rng)
            corners += [*spot, ground(spot[None])[0] - corners[:, 2].min() - 0.05]
            _add(scene, corners, ConvexHull(corners).simplices)
            centres.append(corners.mean(axis=0))
    return scene, np.array(centres)


def _add(scene: o3d.t.geometry.RaycastingScene, vertices: Float, faces: Float) -> None:
    scene.add_triangles(
        o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(faces.astype(np.uint32))
    )


def _seen(
    scene: o3d.t.geometry.RaycastingScene, origins: Float, directions: Float, noise: Float
) -> Float:
    rays = np.column_stack([origins, directions]).astype(np.float32)
    ranges = scene.cast_rays(o3d.core.Tensor(rays))["t_hit"].numpy().astype(float)
    hit = ranges < 14
    return np.asarray(origins[hit] + directions[hit] * (ranges + noise)[hit, None])


def _thin(points: Float, voxel_m: float) -> Float:
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.array(points)))
    return np.asarray(cloud.voxel_down_sample(voxel_m).points)


def _swept(
    scene: o3d.t.geometry.RaycastingScene, rng: np.random.Generator, rays: int, noise: float = 1.0
) -> Float:
    """Return what two lidars on a swinging cabin's roof see: from one side only."""
    swing = rng.uniform(-1.9, 1.9, rays)
    side = rng.choice([-0.6, 0.6], rays)
    origins = np.column_stack(
        [
            1.3 * np.cos(swing) - side * np.sin(swing),
            1.3 * np.sin(swing) + side * np.cos(swing),
            np.full(rays, 2.9),
        ]
    )
    azimuth, elevation = swing + rng.uniform(-0.9, 0.9, rays), -rng.uniform(0.15, 1.3, rays)
    directions = np.column_stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    points = _thin(_seen(scene, origins, directions, rng.normal(0, 0.012 * noise, rays)), 0.03)
    return points[np.linalg.norm(points[:, :2], axis=1) < 10]


def _surveyed(
    scene: o3d.t.geometry.RaycastingScene,
    rng: np.random.Generator,
    rays: int,
    centre: Float,
    noise: float = 1.0,
) -> Float:
    """Return what a drone sees from twenty places around, warped smoothly by a
    centimetre or two.
    """
    around = rng.integers(20, size=rays) * 2 * np.pi / 20
    origins = centre + np.column_stack([7 * np.cos(around), 7 * np.sin(around), np.full(rays, 6.0)])
    aims = centre + np.column_stack([rng.uniform(-5.5, 5.5, (rays, 2)), np.zeros(rays)])
    directions = (aims - origins) / np.linalg.norm(aims - origins, axis=1)[:, None]
    points = _thin(_seen(scene, origins, directions, rng.normal(0, 0.015 * noise, rays)), 0.025)
    warp = 0.012 * np.sin(points[:, [1, 2, 0]] * rng.uniform(0.3, 0.8, 3) + rng.uniform(0, 6.28, 3))
    return points + warp


def scene_of(
    seed: int,
    count: int = 7,
    rays: int = 250_000,
    survey_seed: int | None = None,
    stretch: float | None = None,
    stone: StoneMaker = _stone,
    noise: float = 1.0,
) -> Scene:
    """Return the scene of a seed.

    Args:
        seed: All chance follows from it.
        count: Number of stones.
        rays: Rays of the lidars, and of the drone.
        survey_seed: If given, the drone flew over another site, the one of this seed.
        stretch: Factor by which the survey is too large; drawn from 0.99 to 1.01 if not given.
        stone: Draws the corners of one stone.
        noise: Factor on the noise of both sensors, 12 and 15 mm.
    """
    rng = np.random.default_rng(seed)
    scene, stones = _world(rng, count, 3.2, 7.5, stone)
    centre = np.array([*stones[:, :2].mean(axis=0), 0.3])
    target = _swept(scene, rng, rays, noise)
    if survey_seed is not None:
        scene, stones = _world(np.random.default_rng(survey_seed), count, 3.2, 7.5, stone)
        centre = np.array([*stones[:, :2].mean(axis=0), 0.3])
    survey = _surveyed(scene, rng, rays, centre, noise)
    drawn = float(rng.uniform(0.99, 1.01))
    stretch = drawn if stretch is None else stretch
    R = exp_so3(np.array([0, 0, rng.uniform(-np.pi, np.pi)])) @ exp_so3(rng.normal(0, 0.03, 3))
    T = pose(R, rng.uniform(-15, 15, 3))
    source = transform(inverse(T), centre + (survey - centre) * stretch)
    clouds = Cloud("map", target), Cloud("survey", source)
    return Scene(*clouds, T, stretch, centre, stones, is_same_site=survey_seed is None)


def _shared(name: str) -> Scene:
    """Return one of the clouds that came with the project's papers; skips where they are not."""
    folder = SHARED / name
    if not folder.is_dir():
        pytest.skip("the shared example clouds are not here")
    target, source = (Cloud(k, read_points(folder / f"{k}.ply")) for k in ("lidar", "drone"))
    truth = json.loads((folder / "truth.json").read_text())
    T, centre, stones = (np.array(truth[k]) for k in ("T_MS", "center", "stone_centroids"))
    same = not truth.get("must_refuse", False)
    return Scene(target, source, T, truth["scale"], centre, stones, is_same_site=same)


# Clouds of every kind that registration has to decide on, made here, and four that are given.
EXAMPLES: dict[str, Callable[[], Scene]] = {
    "quarried": lambda: scene_of(600, stone=_quarried),
    "rounded": lambda: scene_of(601, stone=_rounded),
    "sparse": lambda: scene_of(602, rays=60_000, stone=_quarried),
    "other_site": lambda: scene_of(603, survey_seed=1603, stone=_rounded),
    "shared_paper_000": lambda: _shared("paper_000"),
    "shared_paper_001": lambda: _shared("paper_001"),
    "shared_sparse_200": lambda: _shared("sparse_200"),
    "shared_wrongsite_500": lambda: _shared("wrongsite_500"),
}


@pytest.fixture(scope="session", params=list(EXAMPLES))
def example(request: pytest.FixtureRequest) -> Scene:
    """Return each example scene in turn."""
    return EXAMPLES[request.param]()


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., Scene]:
    """Return the function that makes the scene of a seed."""
    return scene_of
