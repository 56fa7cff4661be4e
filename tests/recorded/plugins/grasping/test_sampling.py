"""Sampling of grasps: tables of the gripper, ground, clouds, frames, closing, costs and orders."""

import numpy as np
import pytest
from executive_plugins.grasping.sampling.closing import Clearance, Hypotheses, push_and_close
from executive_plugins.grasping.sampling.frames import (
    downward_frames,
    local_frames,
    turned_frames,
)
from executive_plugins.grasping.sampling.ground import fill_ground, fit_ground
from executive_plugins.grasping.sampling.jaw_field import build_jaw_field
from executive_plugins.grasping.sampling.planning_cloud import build_planning_cloud
from executive_plugins.grasping.sampling.pool import Sampler
from executive_plugins.grasping.sampling.ranking import (
    best_first,
    paper_costs,
    ranked_rounds,
    spread,
)
from executive_plugins.grasping.sampling.settings import SamplingSettings

from executive.geometry.normals import outward_normals
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3, from_rpy

COARSE = {"samples": 12, "turns_about_y": 3, "turns_about_z": 3, "downward_yaws": 6}


def ellipsoid(count: int = 1200) -> np.ndarray:
    i = np.arange(count) + 0.5
    polar, azimuth = np.arccos(1 - 2 * i / count), np.pi * (1 + 5**0.5) * i
    x, y = np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar)
    points = np.column_stack([x, y, np.cos(polar)]) * (0.6, 0.45, 0.4) + (0, 0, 0.35)
    return points[points[:, 2] > 0.02]


@pytest.fixture(scope="session")
def field(gripper):
    """Tables of coarse cells."""
    return build_jaw_field(gripper, 0.06, 0.03, 9)


def test_tables(recorded, field) -> None:
    recorded(field)


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_ground(recorded, scale) -> None:
    rng, told = np.random.default_rng(1), []
    xy = rng.uniform(-1.5, 1.5, (900, 2))
    slope = np.c_[xy, 0.2 * xy[:, 0] + rng.normal(0, 0.02, 900)]
    steep = np.c_[xy, 2.0 * xy[:, 0]]
    stone = ellipsoid(200) - [0, 0, 0.1]
    for around in (slope, steep, slope[:2], np.vstack([slope, ellipsoid() + [0.9, 0.9, 0.1]])):
        ground = fit_ground(around, stone, np.random.default_rng(2), scale)
        told.append((ground, ground.height(xy[:9])))
        told.append(fill_ground(ground, stone, np.full(2, -0.8), np.full(2, 0.9), 0.15))
    recorded(told)


def test_planning_clouds(recorded) -> None:
    rng, told = np.random.default_rng(3), []
    xy = rng.uniform(-2, 2, (4000, 2))
    ground = np.c_[xy, 0.02 * np.sin(5 * xy[:, 0])]
    ground = ground[np.linalg.norm(xy / (0.6, 0.45), axis=1) > 0.9]
    stone = ellipsoid()
    for turn, scale in ((0.0, 1.0), (2.0, 1.0), (0.5, 0.8)):
        T = pose(from_rpy(0, 0, turn), np.array([5.0, 1.0, 0.2]))
        seen = stone[stone[:, 2] > 0.12] @ T[:3, :3].T + T[:3, 3]
        cloud = np.vstack([stone, ground]) @ T[:3, :3].T + T[:3, 3]
        made = build_planning_cloud(seen, cloud, 0.6, 0.08, np.random.default_rng(4), scale)
        told.append((made, made.body(), made.least_width_m, made.stone, made.body(0.4)))
    recorded(told)


def test_frames(recorded) -> None:
    points = ellipsoid(300)
    normals = outward_normals(points, np.array([0.0, 0, 0.35]))
    frames = local_frames(points, normals, points[::20], 0.25)
    told = (
        normals,
        outward_normals(points, points[0], 5),
        frames,
        outward_normals(points[:3], points[9]),
    )
    turned = turned_frames(frames[:2], np.array([-0.5, 0.0, 0.7]), np.array([-1.0, 0.3]))
    recorded((told, turned, downward_frames(np.array([0.0, 0.5, 2.0]))))


def hypotheses(count: int = 24) -> Hypotheses:
    rng = np.random.default_rng(5)
    down = downward_frames(rng.uniform(0, np.pi, count))
    R = np.array([exp_so3(0.3 * rng.normal(size=3)) @ one for one in down])
    return Hypotheses(
        R, rng.uniform(-0.35, 0.35, (count, 3)) + (0, 0, 0.3), np.arange(count) % 2 == 0
    )


@pytest.mark.parametrize("clearance", [(0.04, 0.02, 0.02), (0.0, 0.1, -0.2), (0.3, 0.0, 0.3)])
def test_closing(recorded, field, clearance) -> None:
    stone, told = ellipsoid(600), []
    xy = np.random.default_rng(6).uniform(-1.5, 1.5, (1500, 2))
    ground = np.c_[xy, 0 * xy[:, 0]]
    wall = np.random.default_rng(7).uniform(0, 1, (400, 3)) * (0.1, 2, 0.9) + (0.75, -1, 0)
    for others in (ground, np.vstack([ground, wall]), ground[:0], wall + (0, 0, -3)):
        points = np.vstack([others, stone])
        is_target = np.arange(len(points)) >= len(others)
        told.append(
            push_and_close(
                field,
                points,
                is_target,
                np.array([0, 0, 0.35]),
                hypotheses(),
                Clearance(*clearance),
            )
        )
    recorded(told)


@pytest.mark.parametrize("changed", [{}, {"max_tilt_rad": 0.2, "downward_yaws": 0}, {"scale": 0.9}])
def test_pools(recorded, gripper, tables, changed) -> None:
    sampler = Sampler(SamplingSettings(**COARSE | changed), gripper)
    sampler._tables = tables if "scale" not in changed else None
    # Rough, because candidates on a smooth body tie, and a processor's rounding decides then.
    drawn = np.random.default_rng(8)
    ground = np.c_[drawn.uniform(-2, 2, (3000, 2)), drawn.normal(0, 0.005, 3000)]
    stone = ellipsoid()
    stone = stone + drawn.normal(0, 0.005, stone.shape)
    cloud = np.vstack([stone, ground])
    rng = np.random.default_rng(9)
    pool = sampler.pool(sampler.scene(stone, cloud, rng), rng)
    recorded((len(pool), pool, pool.taken(np.array([0])) if len(pool) else None))


def test_orders(recorded) -> None:
    rng = np.random.default_rng(10)
    costs = {name: rng.integers(0, 4, 30) / 2.0 for name in "abc"}
    told = [list(ranked_rounds(costs, [("a", 9), ("b", 4)], "c"))]
    told.append(best_first(costs, [("b", 40), ("a", 5)], "c", np.arange(4, 25)))
    R = np.array([exp_so3(np.array([0, 0, 0.1 * (k % 6)])) for k in range(30)])
    R[20:] = R[20:] @ np.diag([1.0, -1, -1])
    position = np.c_[np.arange(30) // 10 * 0.05, np.zeros((30, 2))]
    told += [list(spread(range(30), R, position, s, t)) for s, t in ((0.05, 0.25), (0.04, 0.45))]
    normal = np.array([0.0, 0.6, 0.8])
    recorded((told, paper_costs(R, position, np.array([0.1, 0.2, -0.4]), normal)))
