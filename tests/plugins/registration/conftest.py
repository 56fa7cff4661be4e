"""Scenes with truth: stones on rough ground, seen by lidars from the machine and by a drone from
above.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import open3d as o3d
import pytest
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.messages.cloud import Cloud


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A map and a survey of one site; p_target = c + (T p_source − c) / stretch undoes the survey's
    frame and scale.
    """

    target: Cloud
    source: Cloud
    T_target_source: Float
    stretch: float
    centre: Float
    stones: Float

    def errors(self, apply: Callable[[Float], Float]) -> tuple[float, float]:
        """Return the largest error over the site [m] and that at its centre [m] of a map from
        source to target.
        """
        corners = self.centre + np.array([[x, y, 0.0] for x in (-4, 0, 4) for y in (-4, 0, 4)])
        in_source = transform(
            inverse(self.T_target_source), self.centre + (corners - self.centre) * self.stretch
        )
        distances = np.linalg.norm(apply(in_source) - corners, axis=1)
        return float(distances.max()), float(distances[4])


def _stone(rng: np.random.Generator) -> Float:
    """Return corners of a convex stone of 0.5 to 1 m³ about the origin."""
    points = rng.normal(size=(26, 3))
    points *= (1 / np.linalg.norm(points, axis=1) * rng.uniform(0.85, 1.1, 26))[:, None]
    points *= np.array(
        [1.0, np.clip(rng.normal(0.76, 0.13), 0.5, 1), np.clip(rng.normal(0.55, 0.14), 0.35, 1)]
    )
    points *= (rng.uniform(0.5, 1.0) / ConvexHull(points).volume) ** (1 / 3)
    turned = points @ exp_so3(rng.normal(0, 0.25, 3)).T
    return np.asarray(turned @ exp_so3(np.array([0, 0, rng.uniform(-np.pi, np.pi)])).T)


def _world(
    rng: np.random.Generator, count: int, near_m: float, far_m: float
) -> tuple[o3d.t.geometry.RaycastingScene, Float]:
    """Return a site about the origin: waves of 4 cm, ruts of 1 cm, stones between two distances in
    front and aside.
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
            corners = _stone(rng)
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


def _swept(scene: o3d.t.geometry.RaycastingScene, rng: np.random.Generator, rays: int) -> Float:
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
    points = _thin(_seen(scene, origins, directions, rng.normal(0, 0.012, rays)), 0.03)
    return points[np.linalg.norm(points[:, :2], axis=1) < 10]


def _surveyed(
    scene: o3d.t.geometry.RaycastingScene, rng: np.random.Generator, rays: int, centre: Float
) -> Float:
    """Return what a drone sees from twenty places around, warped smoothly by a
    centimetre or two.
    """
    around = rng.integers(20, size=rays) * 2 * np.pi / 20
    origins = centre + np.column_stack([7 * np.cos(around), 7 * np.sin(around), np.full(rays, 6.0)])
    aims = centre + np.column_stack([rng.uniform(-5.5, 5.5, (rays, 2)), np.zeros(rays)])
    directions = (aims - origins) / np.linalg.norm(aims - origins, axis=1)[:, None]
    points = _thin(_seen(scene, origins, directions, rng.normal(0, 0.015, rays)), 0.025)
    warp = 0.012 * np.sin(points[:, [1, 2, 0]] * rng.uniform(0.3, 0.8, 3) + rng.uniform(0, 6.28, 3))
    return points + warp


def scene_of(
    seed: int,
    count: int = 7,
    rays: int = 250_000,
    survey_seed: int | None = None,
    stretch: float | None = None,
) -> Scene:
    """Return the scene of a seed; with `survey_seed` the drone flew over another site, which must
    be refused.
    """
    rng = np.random.default_rng(seed)
    scene, stones = _world(rng, count, 3.2, 7.5)
    centre = np.array([*stones[:, :2].mean(axis=0), 0.3])
    target = _swept(scene, rng, rays)
    if survey_seed is not None:
        scene, stones = _world(np.random.default_rng(survey_seed), count, 3.2, 7.5)
        centre = np.array([*stones[:, :2].mean(axis=0), 0.3])
    survey = _surveyed(scene, rng, rays, centre)
    drawn = float(rng.uniform(0.99, 1.01))
    stretch = drawn if stretch is None else stretch
    R = exp_so3(np.array([0, 0, rng.uniform(-np.pi, np.pi)])) @ exp_so3(rng.normal(0, 0.03, 3))
    T = pose(R, rng.uniform(-15, 15, 3))
    source = transform(inverse(T), centre + (survey - centre) * stretch)
    return Scene(Cloud("map", target), Cloud("survey", source), T, stretch, centre, stones)


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., Scene]:
    """Return a maker of scenes by seed."""
    return scene_of
