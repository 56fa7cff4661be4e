"""The parts of motion planning: bodies, ground, obstacles, kinematics, paths, timing, sweeps."""

import numpy as np
import pytest
from executive_plugins.motion.collision import CollisionCheck
from executive_plugins.motion.convex_body import ConvexBody
from executive_plugins.motion.forward_kinematics import link_frames
from executive_plugins.motion.ground import ground_normal
from executive_plugins.motion.ground_heights import ground_heights
from executive_plugins.motion.inverse_kinematics import InverseKinematics
from executive_plugins.motion.obstacles import Obstacles
from executive_plugins.motion.path import path_through
from executive_plugins.motion.self_collision import SelfCollision, held_body, machine_bodies
from executive_plugins.motion.settings import InverseKinematicsSettings
from executive_plugins.motion.sweep import chain, sweep
from executive_plugins.motion.timing import Limits, time_path
from executive_plugins.motion.waypoints import Waypoints, join, reach_below_m

from executive.errors import ShapeError
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3, from_rpy
from executive.machine.kinematics import Kinematics

# Iterations stop at a tolerance of their own, and their last steps are small.
ITERATED = 1e-7


def field(seed: int, count: int = 3000) -> np.ndarray:
    """Return a slope with stones and a shadow."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-4, 4, (count, 2))
    z = 0.1 * xy[:, 0] + 0.05 * np.sin(2 * xy[:, 1])
    for x, y, r in ((1.0, 1.0, 0.6), (-2.0, 0.5, 0.5), (0.5, -2.0, 0.8)):
        d2 = ((xy - (x, y)) ** 2).sum(axis=1)
        z = np.where(d2 < r * r, z + np.sqrt(np.maximum(r * r - d2, 0)), z)
    seen = (np.abs(xy[:, 0] + 2.5) > 0.6) | (np.abs(xy[:, 1] - 2.0) > 0.8)
    return np.c_[xy, z][seen]


def test_bodies(recorded) -> None:
    rng, told = np.random.default_rng(1), []
    for points in (rng.normal(0, 0.3, (20, 3)), rng.integers(0, 2, (30, 3)) * [0.4, 0.3, 0.05]):
        body = ConvexBody("link", points, "body")
        told += [body.corners, body.sphere, body.thickness_m, body.half_spaces, body.samples]
        told.append(body.depths(rng.normal(0, 0.3, (9, 3))))
    with pytest.raises(ShapeError) as refused:
        _ = ConvexBody("link", np.eye(3), "flat").corners
    recorded((told, str(refused.value)[:40]))


def test_ground(recorded) -> None:
    points, told = field(1), []
    for place in ((0.0, 0.0, 0.0), (1.0, 1.0, 0.5), (-3.9, -3.9, 0), (9.0, 9.0, 0.0)):
        told.append(ground_normal(points, np.array(place)))
    wall = np.c_[points[:, :2], 5.0 * points[:, 0]]
    told += [ground_normal(wall, np.zeros(3)), ground_normal(points[:0], np.zeros(3))]
    told += [ground_normal(points[::k], np.zeros(3)) for k in (40, 120, 200)]
    recorded(told)


def test_ground_heights(recorded) -> None:
    centres = np.arange(-3.75, 4.0, 0.5)
    told = [ground_heights(field(k, n), centres) for k, n in ((2, 3000), (3, 200), (4, 0))]
    told.append(ground_heights(field(5)[:40] * [0.1, 0.1, 1], centres))
    recorded(told)


def test_obstacles(recorded) -> None:
    rng = np.random.default_rng(6)
    obstacles, told = Obstacles(field(6), 3.0), []
    points = rng.uniform(-3.5, 3.5, (200, 3)) * (1, 1, 0.5)
    told += [obstacles.clearances(points), obstacles.depths_in_ground(points)]
    told += [obstacles.is_ground.sum(), obstacles.points]
    for azimuths in ((0.0, 1.0), (2.0, -1.0), (-3.0, 3.2), (0.5, 0.5)):
        told += [
            obstacles.highest(azimuths, radii) for radii in ((0.5, 2.0), (2.0, 9.0), (0, 0.01))
        ]
    told += [obstacles.in_box(np.full(3, -a), np.full(3, a)).tolist() for a in (0.5, 1.5, 9.0)]
    empty = Obstacles(np.zeros((0, 3)), 2.0)
    told += [empty.highest((0.0, 3.0), (0.0, 9.0)), empty.clearances(points[:3])]
    recorded(told)


def test_paths(recorded) -> None:
    rng, told = np.random.default_rng(7), []
    nodes = rng.normal(0, 1, (6, 3))
    nodes[3] = nodes[2]
    for dense in ([0, 0, 0, 0, 0], [1, 1, 0, 0, 1]):
        path = path_through(
            nodes, np.array(dense, bool), np.array([0.5, 1, 2]), np.array([0.3, 1, 3])
        )
        u = np.linspace(0, path.length, 15)
        told.append((path.parameters, path.position(u), path.tangent(u), path.curvature(u)))
    recorded(told)


LIMITS = Limits(np.array([0.5, 0.8, 0.3]), np.array([0.4, 1.0, 0.2]), np.array([1.0, 2.0, 0.8]))


def test_timing(recorded) -> None:
    rng, told = np.random.default_rng(8), []
    for nodes in (
        rng.normal(0, 1, (7, 3)),
        np.array([[0.0, 0, 0], [3, 0, 0]]),
        np.array([[0.0, 0, 0], [0.01, 0, 0.002]]),
        np.array([[0.0, 0, 0], [2, 0.01, 0], [2.01, 1.5, 0], [2.01, 1.5, 2.0]]),
    ):
        dense = np.zeros(len(nodes) - 1, bool)
        path = path_through(nodes, dense, LIMITS.velocity, LIMITS.acceleration)
        told.append(time_path(("a", "b", "c"), path, LIMITS))
    recorded(told, relative=ITERATED)


def test_sweeps(recorded, machine) -> None:
    limits = Limits(machine.max_velocity, machine.max_acceleration, machine.max_jerk)
    scan, carry = machine.posture("scan"), machine.posture("carry")
    cases = ([scan], 1.0, 20.0), ([carry, scan], 0.5, 0.1), ([scan + 5e-4, scan], 1.0, 5.0)
    told = [sweep(machine, limits, *case) for case in cases]
    told += [told[0].slowed(2.0), chain(told[:2])]
    recorded(told, relative=ITERATED)


def test_frames(recorded, machine) -> None:
    rng = np.random.default_rng(9)
    q = machine.posture("carry") + rng.normal(0, 0.1, (3, len(machine.joints)))
    recorded(link_frames(machine, q, 0.4))


def test_inverse_kinematics(recorded, machine) -> None:
    kinematics, told = Kinematics(machine), []
    ik = InverseKinematics(InverseKinematicsSettings(), machine, kinematics)
    carry, rng = machine.posture("carry"), np.random.default_rng(10)
    for k in range(12):
        q = np.clip(carry + rng.normal(0, 0.25, len(carry)), machine.lower, machine.upper)
        T = kinematics.gripper(q)
        T = pose(exp_so3(0.02 * (k % 3) * rng.normal(size=3)) @ T[:3, :3], T[:3, 3] + 0.3 * (k % 4))
        told.append(ik.solve(T, carry))
        told.append(ik.solve(T, carry, lambda q: q[1] > carry[1]))
        told.append(ik.track(kinematics.gripper(q), q - 0.02))
    for far in ((30.0, 0, 0), (0.1, 0.1, 1.0), (machine.reach_m + 0.9, 0, 0)):
        told.append(ik.solve(pose(from_rpy(0, 1.5, 0), np.array(far)), carry))
    told.append(ik.track(kinematics.gripper(carry + 0.5), carry))
    told.append(ik.nearest_turn(carry + 7.0, carry))
    recorded(told, relative=ITERATED, absolute=1e-9)


def test_waypoints(recorded, machine) -> None:
    kinematics, told = Kinematics(machine), []
    ik = InverseKinematics(InverseKinematicsSettings(), machine, kinematics)
    waypoints, carry = Waypoints(machine, kinematics, ik), machine.posture("carry")
    up = np.array([0.0, 0.0, 1.0])
    lines = [
        waypoints.line_up(carry, d, m) for d, m in ((up, 0.5), (-up, 0.3), (up, 30.0), (up, 0.0))
    ]
    lines.append(waypoints.line_up(carry, np.array([0.6, 0.0, 0.8]), 0.17))
    z = kinematics.gripper(carry)[2, 3]
    told += [lines, [waypoints.lift(carry, z + d) for d in (-1.0, 0.04, 0.06, 0.9, 30.0)]]
    told += [waypoints.turn_shifts(carry, carry + d) for d in (0.0, 1.0, -1.0)]
    told += [waypoints.shifted(lines[0].nodes, 0.5), join(lines[0], [carry], lines[1])]
    told += [join(lines[3], [], lines[0])]
    told.append(reach_below_m(kinematics.gripper(carry), field(1)[:30]))
    recorded(told, relative=ITERATED, absolute=1e-9)


def test_collisions(recorded, machine) -> None:
    bodies, told = machine_bodies(machine), []
    rng = np.random.default_rng(11)
    scan, carry = machine.posture("scan"), machine.posture("carry")
    held = held_body(machine, rng.normal(0, 0.4, (400, 3)) + machine.gripper.grasp_centre)
    folded = np.linspace(carry, machine.lower.clip(-3, 3), 9)
    for clearance, stone in ((0.0, None), (0.05, None), (0.5, None), (0.05, held)):
        check = SelfCollision(machine, bodies, clearance, stone)
        told.append(check.first_hit(link_frames(machine, folded, 0.3)))
        ground = field(12) * (2.5, 2.5, 1) + (0, 0, -machine.stance.base_height_m)
        for tolerance_m in (0.0, 0.1):
            around = CollisionCheck(check, Obstacles(ground, 9.0), carry, 0.3, tolerance_m)
            told += [
                around.first_hit(np.linspace(carry, q, 20)) for q in (scan, folded[-1], carry - 0.4)
            ]
            told += [around.machine_hit(folded), around.first_hit(carry[None])]
    recorded(told, relative=ITERATED)
