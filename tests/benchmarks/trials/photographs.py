"""From a drone's photographs to a registered map: pictures in place, and how good the cloud is."""

import resource
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import open3d as o3d
from bounds import Bound, Figure, held, judged
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.site.ray_mesh import joined, moved
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from executive_plugins.surveying import photogrammetry
from executive_plugins.surveying.colmap import FEWEST_PICTURES
from executive_plugins.surveying.photogrammetry import Photogrammetry, reconstruct
from executive_plugins.surveying.photograph_folder import read_photographs
from executive_plugins.surveying.settings import GridFlightSettings, PhotogrammetrySettings
from executive_plugins.surveying.simulated_photographs import take_photographs
from scipy.spatial import cKDTree

from executive import registry
from executive.arrays import Float
from executive.geometry.pose import transform
from executive.geometry.rigid_fit import similarity_fit
from executive.geometry.rotation import angle_between
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud

METHODS = ("segment_fpfh", "segment_shot")
STAGES = ("find_motion", "_depths", "fuse")
RAYS = 250_000


def measured(seed: int, noise_m: float) -> list[Figure]:
    """Photograph a site, make its cloud, and register that on a lidar map."""
    robot = MujocoRobot(MujocoSettings(), load_machine("m545"), np.random.default_rng(seed))
    robot.start()
    flight = GridFlightSettings(noise_m=noise_m)
    spent = {"photographs": -time.process_time()}
    with tempfile.TemporaryDirectory() as scratch, ExitStack() as timing:
        folder = Path(scratch)
        poses = np.array(take_photographs(robot, flight, folder, np.random.default_rng(seed)))
        spent["photographs"] += time.process_time()
        for stage in STAGES:
            timed = _timed(getattr(photogrammetry, stage), stage, spent)
            timing.enter_context(patch.object(photogrammetry, stage, timed))
        photographs = read_photographs(folder, None, FEWEST_PICTURES)
        found = reconstruct(photographs, PhotogrammetrySettings(), np.random.default_rng(seed))
    figures = _reported(seed, noise_m, photographs.names, found, poses, robot, spent)
    target = Cloud("map", _swept(robot, np.random.default_rng(seed)))
    for method in METHODS:
        accepted = _register(method, target, found, poses, photographs.names)
        words = "accepted" if accepted else "refused"
        figures.append(judged(f"seed {seed}: {method}", words, "accepted", accepted))
    return figures


def _timed(function: Callable[..., Any], name: str, spent: dict[str, float]) -> Callable[..., Any]:
    def timed(*args: Any) -> Any:
        start_s = time.process_time()
        try:
            return function(*args)
        finally:
            spent[name] = time.process_time() - start_s

    return timed


def _truth(
    found: Photogrammetry, names: tuple[str, ...], poses: Float
) -> tuple[tuple[float, Float, Float], Float]:
    """Return the similarity from the survey to the world by the cameras' true places, and their
    distances after it.
    """
    true = poses[[names.index(name) for name in found.names], :3, 3]
    scale, R, t = similarity_fit(true, found.centres_m)
    return (scale, R, t), np.linalg.norm(scale * found.centres_m @ R.T + t - true, axis=1)


def _reported(
    seed: int, noise_m: float, names: tuple[str, ...], found: Photogrammetry, poses: Float,
    robot: MujocoRobot,
    spent: dict[str, float],
) -> list[Figure]:  # fmt: skip
    """Print the figures of a survey, and return those that have a bound."""
    (scale, R, t), off = _truth(found, names, poses)
    points = scale * found.cloud.points @ R.T + t
    site = robot.world.site
    distances = _distances(site, points)
    tilt = np.degrees(np.arccos(np.clip(R[2, 2], -1, 1)))
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"\nseed {seed}, positions ±{noise_m} m: {len(found.names)} of {found.pictures} "
        "pictures in place"
    )
    print(
        f"  cameras off {1e3 * np.median(off):.1f} mm (median), {1e3 * off.max():.1f} mm (largest)"
    )
    stated = 100 * found.alignment.scale_error
    print(f"  scale off {100 * (1 / scale - 1):+.2f} %, stated ±{stated:.2f} %, tilt {tilt:.1f}°")
    print(
        f"  {len(points)} points off {1e3 * np.median(distances):.1f} mm (median), "
        f"{1e3 * np.percentile(distances, 95):.1f} mm (p95), "
        f"{100 * (distances > 0.1).mean():.2f} % beyond 0.1 m"
    )
    whole, top = zip(*[_covered(site, i, points) for i in range(len(site.stones))], strict=True)
    print(
        f"  stones covered {np.mean(whole):.2f} (least {min(whole):.2f}), upper halves "
        f"{np.mean(top):.2f}"
    )
    print(
        "  "
        + ", ".join(f"{name} {seconds:.0f} s" for name, seconds in spent.items())
        + f"; peak {peak_mb:.0f} MB"
    )
    placed, p95_mm = len(found.names), 1e3 * float(np.percentile(distances, 95))
    return [
        judged(
            f"seed {seed}: pictures in place",
            f"{placed} of {found.pictures}",
            "all",
            placed == found.pictures,
        ),
        held(f"seed {seed}: points off the true surface, p95 [mm]", p95_mm, Bound(40.0)),
    ]


def _distances(site: Site, points: Float) -> Float:
    """Return how far points are from the ground and the stones [m]."""
    skins = [
        moved((s.vertices, s.triangles), T)
        for s, T in zip(site.stones, site.T_world_stones, strict=True)
    ]
    vertices, triangles = joined([site.terrain.mesh(), *skins])
    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(triangles.astype(np.uint32))
    )  # fmt: skip
    return np.asarray(
        scene.compute_distance(o3d.core.Tensor(points.astype(np.float32)), nthreads=1).numpy()
    )


def _covered(site: Site, i: int, points: Float) -> tuple[float, float]:
    """Return the share of a stone's skin above the ground that has a point within 5 cm, and that of
    its upper half.
    """
    stone, T = site.stones[i], site.T_world_stones[i]
    mesh = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(transform(T, stone.vertices)),
        o3d.utility.Vector3iVector(stone.triangles),
    )
    o3d.utility.random.seed(0)
    skin = np.asarray(mesh.sample_points_uniformly(3000).points)
    skin = skin[skin[:, 2] > site.terrain.height_at(skin[:, :2]) + 0.05]
    is_near = cKDTree(points).query(skin)[0] < 0.05
    return float(is_near.mean()), float(is_near[skin[:, 2] > np.median(skin[:, 2])].mean())


def _swept(robot: MujocoRobot, rng: np.random.Generator) -> Float:
    """Return what two lidars on a swinging cabin's roof see of the site, with 12 mm of noise,
    thinned to 3 cm.
    """
    swing, side = rng.uniform(-1.9, 1.9, RAYS), rng.choice([-0.6, 0.6], RAYS)
    origins = np.column_stack(
        [
            1.3 * np.cos(swing) - side * np.sin(swing),
            1.3 * np.sin(swing) + side * np.cos(swing),
            np.full(RAYS, 2.9),
        ]
    )
    azimuth, elevation = swing + rng.uniform(-0.9, 0.9, RAYS), -rng.uniform(0.15, 1.3, RAYS)
    directions = np.column_stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    ranges = robot.cast_rays(origins, directions)
    hit = ranges < 14
    points = (origins + directions * (ranges + rng.normal(0, 0.012, RAYS))[:, None])[hit]
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points)).voxel_down_sample(0.03)
    points = np.asarray(cloud.points)
    return points[np.linalg.norm(points[:, :2], axis=1) < 10]


def _register(
    method: str, target: Cloud, found: Photogrammetry, poses: Float, names: tuple[str, ...]
) -> bool:
    plugin = registry.load("registration", method)
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    registrar = plugin(plugin.Settings(), segmentation, Gicp(GicpSettings()))
    segmentation.start()
    registrar.start()
    start_s = time.process_time()
    answer = registrar.register(target, found.cloud, np.random.default_rng(0))
    spent_s = time.process_time() - start_s
    registrar.close()
    (scale, R, t), _ = _truth(found, names, poses)
    corners = np.array([[3.7 + x, y, 0.3] for x in (-3, 0, 3) for y in (-5, 0, 5)])
    errors = np.linalg.norm(answer.apply((corners - t) @ R / scale) - corners, axis=1)
    turn = np.degrees(angle_between(answer.T_target_source[:3, :3], R))
    print(
        f"  {method}: {'accepted' if answer.accepted else 'REFUSED'} in {spent_s:.1f} s "
        f"({answer.reason}); "
        f"off {1e3 * errors[4]:.0f} mm at the centre, {1e3 * errors.max():.0f} mm at "
        f"the corners, {turn:.2f}°, "
        f"scale {100 * (answer.scale / scale - 1):+.2f} %"
    )
    return bool(answer.accepted)
