"""Lidars see planes, boxes and spheres where they are, while the lidar and the stones move."""

import mujoco
import numpy as np
import open3d as o3d
import pytest
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.sensors.settings import SensorSettings
from executive_plugins.robot.mujoco.sensors.suite import SensorSuite
from executive_plugins.robot.mujoco.site.ray_mesh import RayMesh
from executive_plugins.robot.mujoco.site.settings import TerrainSettings
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.site_scene import SiteScene
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.world import World

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis
from executive.machine.machine import load_machine
from executive.messages.lidar import LidarScan

MACHINE = load_machine("m545")
STEP_S = 0.01
NOISE_M = MACHINE.sensors["lidar_vertical"].range_noise_m
Z = np.array([0.0, 0.0, 1.0])


def cuboid(*sides: float) -> StoneModel:
    mesh = o3d.geometry.TriangleMesh.create_box(*sides)
    skin = np.asarray(mesh.vertices), np.asarray(mesh.triangles).astype(np.int64)
    return StoneModel.from_skin("stone_1", skin, 2700.0)


def level_site(T_world_stone: Float, *sides: float) -> Site:
    ground = make_terrain(TerrainSettings(undulation_m=0, roughness_m=0), np.random.default_rng(0))
    return Site(ground, (cuboid(*sides),), (T_world_stone,))


def distance_to_cuboid(points: Float, sides: Float) -> Float:
    """Return the distance to the surface of a cuboid about the origin [m]."""
    beyond = np.abs(points) - np.array(sides) / 2
    return np.where(
        (beyond > 0).any(axis=1), np.linalg.norm(np.maximum(beyond, 0), axis=1), -beyond.max(axis=1)
    )


def test_rays_hit_a_sphere_and_a_plane_at_the_range_of_the_formula() -> None:
    sphere = o3d.geometry.TriangleMesh.create_sphere(1.0, 200)
    mesh = RayMesh(
        [(np.asarray(sphere.vertices) + np.array([5, 0, 0]), np.asarray(sphere.triangles))]
    )
    rng = np.random.default_rng(0)
    directions = np.array([1.0, 0, 0]) + rng.uniform(-0.3, 0.3, (500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    ranges = mesh.cast(np.hstack([np.zeros((500, 3)), directions]).astype(np.float32))
    b = 5 * directions[:, 0]
    inside = b**2 - 24
    hits = inside > 0.01
    assert np.allclose(
        ranges[hits], b[hits] - np.sqrt(inside[hits]), atol=2e-3
    )  # chords of 1/200 of the circle
    assert np.isinf(ranges[inside < 0]).all()
    assert np.isinf(RayMesh([]).cast(np.zeros((3, 6), np.float32))).all()


def test_the_scene_is_ground_and_stones_also_while_a_stone_moves() -> None:
    sides = (1.0, 0.8, 0.6)
    scene = SiteScene(level_site(pose(t=np.array([5, 0, 0.3])), *sides))
    down = np.array([[0, 0, -1.0]] * 3)
    above = np.array([[5.0, 0, 4], [3.0, 0, 4], [7.0, 0, 4]])
    assert scene.cast_rays(above, down) == pytest.approx([3.4, 4.0, 4.0], abs=1e-5)
    for x in (3.0, 7.0, 7.0, 7.0):
        scene.update([pose(t=np.array([x, 0, 0.3]))])
        assert scene.moving == ((0,) if x == 3.0 or scene.moving else ())
        assert scene.cast_rays(above, down) == pytest.approx(
            [4.0, 3.4 if x == 3 else 4.0, 3.4 if x == 7 else 4.0], abs=1e-5
        )
    assert scene.moving == ()
    up = scene.cast_rays(above, -down)
    assert np.isinf(up).all()


def sweep(
    site: Site, turn_rad_s: float, stone_m_s: float, duration_s: float = 0.6
) -> tuple[World, list[LidarScan]]:
    """Turn the cabin and slide the stone along y, both evenly, and return the scans after the
    first.
    """
    world = World(MACHINE, site, PhysicsSettings())
    suite = SensorSuite(MACHINE, site, SensorSettings(), world.model, np.random.default_rng(0))
    suite.lidars_on = True
    data = mujoco.MjData(world.model)
    data.qpos[:] = world.data.qpos
    start = site.T_world_stones[0][1, 3]
    scans: list[LidarScan] = []
    for k in range(1, round(duration_s / STEP_S) + 1):
        data.joint("J_TURN").qpos = turn_rad_s * k * STEP_S
        data.joint("stone_1").qpos[1] = start + stone_m_s * k * STEP_S
        scans += [o for o in suite.step(k * STEP_S, world.model, data) if isinstance(o, LidarScan)]
    return world, scans


def in_world(world: World, scan: LidarScan, turn_rad_s: float, stamps_s: Float) -> Float:
    """Return the points in the world, undistorted by the cabin's true pose at given times."""
    T_base_cabin = inverse(world.T_world_base) @ world.T_world_body("cabin")
    points = transform(MACHINE.sensors[scan.frame].T_link_sensor, scan.points_lidar)
    c, s = np.cos(turn_rad_s * stamps_s), np.sin(turn_rad_s * stamps_s)
    turned = np.c_[
        c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1], points[:, 2]
    ]
    return turned + T_base_cabin[:3, 3] + world.T_world_base[:3, 3]


SIDES = (1.2, 0.9, 0.8)
T_STONE = pose(about_axis(Z, 0.4), np.array([5.2, 2.0, 0.4]))


def test_a_still_scan_lies_on_ground_and_stone_with_the_noise_of_the_description() -> None:
    world, scans = sweep(level_site(T_STONE, *SIDES), 0.0, 0.0, 0.25)
    assert len(scans) == 2
    for scan in scans:
        ranges = np.linalg.norm(scan.points_lidar, axis=1)
        directions = scan.points_lidar / ranges[:, None]
        T = world.T_world_body("cabin") @ MACHINE.sensors[scan.frame].T_link_sensor
        falls = directions @ T[:3, :3].T @ -Z
        down = falls > 0.05
        expected = T[2, 3] / falls[down]
        points = transform(T, scan.points_lidar)[down]
        is_ground = np.abs(ranges[down] - expected) < 6 * NOISE_M
        assert is_ground.sum() > 1000
        error = (ranges[down] - expected)[is_ground]
        assert error.std() == pytest.approx(NOISE_M, rel=0.06)
        assert abs(error.mean()) < 4 * NOISE_M / np.sqrt(len(error))
        stone = points[
            distance_to_cuboid(transform(inverse(T_STONE), points), np.array(SIDES)) < 0.1
        ]
        assert (
            stone[:, 2] > 0.15
        ).sum() > 50 or scan.frame == "lidar_vertical"  # its plane passes by


def test_points_corrected_by_the_true_motion_lie_on_the_stone_and_uncorrected_ones_do_not() -> None:
    rate = 0.8
    world, scans = sweep(level_site(T_STONE, *SIDES), rate, 0.0)
    to_stone = inverse(T_STONE)

    def spread(use_own_stamps: bool) -> float:
        residuals = []
        for scan in scans:
            if scan.frame != "lidar_horizontal":
                continue
            stamps = (
                scan.point_stamps_s
                if use_own_stamps
                else np.full(len(scan.points_lidar), scan.stamp_s)
            )
            points = in_world(world, scan, rate, stamps)
            near = points[
                (np.linalg.norm(points - T_STONE[:3, 3], axis=1) < 1.5) & (points[:, 2] > 0.2)
            ]
            residuals.append(distance_to_cuboid(transform(to_stone, near), np.array(SIDES)))
        return float(np.sqrt((np.concatenate(residuals) ** 2).mean()))

    assert spread(use_own_stamps=True) < 1.1 * NOISE_M
    assert spread(use_own_stamps=False) > 3 * NOISE_M  # 0.8 rad/s · 5.5 m · 50 ms = 0.22 m


def test_a_stone_under_way_is_seen_where_it_is_at_the_time_of_each_point() -> None:
    speed = 0.8
    world, scans = sweep(level_site(T_STONE, *SIDES), 0.0, speed)
    assert len(scans) == 8  # the last revolution has not arrived yet
    for scan in scans:
        if scan.frame != "lidar_horizontal":
            continue
        points = in_world(world, scan, 0.0, scan.point_stamps_s) - speed * scan.point_stamps_s[
            :, None
        ] * [0, 1, 0]
        near = points[
            (np.linalg.norm(points - T_STONE[:3, 3], axis=1) < 1.5) & (points[:, 2] > 0.2)
        ]
        distance = distance_to_cuboid(transform(inverse(T_STONE), near), np.array(SIDES))
        # A slice of 25 ms stands for its middle: up to 0.8 · 12.5 ms = 1 cm more than the noise.
        assert len(near) > 30
        assert np.sqrt((distance**2).mean()) < np.hypot(NOISE_M, 0.01)


def test_the_machine_sees_its_own_arm_and_cabin() -> None:
    world, scans = sweep(level_site(T_STONE, *SIDES), 0.0, 0.0, 0.25)
    for link in ("boom", "cabin"):
        T_link_world = inverse(world.T_world_body(link))
        seen = 0
        for scan in scans:
            points = transform(T_link_world, in_world(world, scan, 0.0, scan.point_stamps_s))
            for shape in MACHINE.links[link].shapes:
                lower, upper = shape.vertices.min(axis=0) - 0.05, shape.vertices.max(axis=0) + 0.05
                seen += int(((points > lower) & (points < upper)).all(axis=1).sum())
        assert seen > 100
