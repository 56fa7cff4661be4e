"""Paths, ground and steering of the chassis on small sites with slopes, holes and blocks."""

import numpy as np
import pytest
from executive_plugins.driving.check import PathCheck
from executive_plugins.driving.drivable_ground import DrivableGround
from executive_plugins.driving.dubins import along_arc, curves
from executive_plugins.driving.footprint import Footprint, footprint
from executive_plugins.driving.planner import Dubins
from executive_plugins.driving.settings import DubinsSettings, GroundSettings
from executive_plugins.driving.tracker import Tracker

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.cloud import Cloud
from executive.messages.drive import DriveRequest

AROUND = np.array([-12.0, -12.0]), np.array([12.0, 12.0])


def plane(slope: float = 0.0, hole: tuple[float, float, float] | None = None) -> np.ndarray:
    x = np.arange(-12.0, 12.0, 0.2)
    xy = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    if hole is not None:
        xy = xy[np.hypot(*(xy - hole[:2]).T) > hole[2]]
    return np.column_stack([xy, slope * xy[:, 0]])


def block(x: float, y: float, height_m: float, half_m: float = 0.4) -> np.ndarray:
    steps = np.arange(-half_m, half_m + 1e-9, 0.1)
    up = np.arange(0.0, height_m + 1e-9, 0.1)
    grid = np.stack(np.meshgrid(steps, steps, up, indexing="ij"), axis=-1).reshape(-1, 3)
    return grid + (x, y, 0.0)


SITES = {
    "level": plane(),
    "slope": plane(0.15),
    "steep": plane(0.6),
    "hole": plane(hole=(5.0, 0.0, 2.0)),
    "blocks": np.vstack([plane(), block(5.0, 0.3, 1.5), block(-3.0, 4.0, 0.2)]),
    "sunk": np.vstack([plane(), block(4.0, -3.0, 0.3) - (0.0, 0.0, 0.6)]),
    "bare": plane()[:0],
}


@pytest.mark.parametrize("site", SITES)
def test_ground(recorded, site) -> None:
    told = []
    places = np.random.default_rng(1).uniform(-13, 13, (40, 2))
    for settings, step_m in (
        (GroundSettings(), 0.25),
        (GroundSettings(cell_m=0.5, widest_object_m=3.0, beside_m=1.0), 0.1),
    ):
        ground = DrivableGround(SITES[site], AROUND, step_m, settings)
        told += [ground.obstacles_map, ground.heights(places), ground.is_seen(places)]
        ground.vouch(np.array([5.0, 0.5]), 2.5)
        told.append(ground.is_seen(places).nonzero()[0])
        told.append(ground.is_seen(places.reshape(4, 10, 2)).sum(axis=1))
    recorded(told)


def test_feet(recorded, machine) -> None:
    told = []
    for clearance_m in (0.0, 0.3):
        foot = footprint(machine, clearance_m)
        points = np.random.default_rng(2).uniform(-6, 6, (200, 3)) * (1, 1, 0.3)
        told += [foot, foot.radius_m, [foot.hits(one[None]) for one in points]]
    edge = Footprint(-np.ones((1, 3)), np.ones((1, 3)), np.zeros((1, 2)))
    told.append([edge.hits(np.array([[x, 1.0, -1.0]])) for x in (1.0, 1.0001)])
    recorded(told)


@pytest.mark.parametrize("site", SITES)
def test_checks(recorded, machine, site) -> None:
    told, foot = [], footprint(machine, 0.2)
    for least_seen in (0.0, 0.6, 1.0):
        for tilt in (0.0, 0.1):
            ground = DrivableGround(SITES[site], AROUND, 0.25, GroundSettings())
            T = pose(from_rpy(0.0, tilt, 0.3), np.array([0.0, 0.0, 0.9]))
            check = PathCheck(machine, foot, ground, T, least_seen)
            for goal in ((6.0, 0.0), (0.0, 5.0), (-5.0, 4.0), (0.1, 0.0), (14.0, 0.0)):
                way = np.linspace((0.0, 0.0), goal, 30)
                yaw = np.arctan2(goal[1], goal[0])
                found = check.trouble(np.column_stack([way, np.full(30, yaw)]))
                told.append(None if found is None else (found[0], found[1]))
    recorded(told)


def test_curves(recorded) -> None:
    told, rng = [], np.random.default_rng(3)
    for _ in range(12):
        start, goal = rng.uniform(-6, 6, (2, 3)) * (1, 1, 0.5)
        for one in curves(start, goal, 2.5):
            poses, curvature = one.sampled(0.7)
            told.append((one.length_m, poses[-1], len(poses), curvature.sum()))
    told += [along_arc(np.array([1.0, 2.0, 0.5]), k, np.arange(4.0)) for k in (0.0, 0.2, -0.4)]
    recorded(np.concatenate([np.ravel(np.hstack([np.ravel(p) for p in one])) for one in told]))


def request(machine, goal, site="level", tilt=0.0) -> DriveRequest:
    T = pose(from_rpy(0, tilt, 0.2), np.array([0.0, 0.0, machine.stance.base_height_m]))
    return DriveRequest(T, np.atleast_2d(np.array(goal)), Cloud("map", SITES[site]))


@pytest.mark.parametrize("site", SITES)
def test_plans(recorded, machine, site) -> None:
    told = []
    planner = Dubins(DubinsSettings(), machine)
    for goal in ((6.0, 3.0, 1.5), (-5.0, 0.0, 0.0), (0.0, 3.0, 3.1), (30.0, 0.0, 0.0)):
        plan = planner.plan(request(machine, goal, site))
        told.append((plan.trouble, plan.reason))
        if plan.path is not None:
            path = plan.path
            told.append((path.length_m, path.poses_map, path.direction, path.curvature_1_m))
    several = np.array([(30.0, 0, 0), (5.0, -1.0, 0.0), (4.0, 0.0, 0.0)])
    told.append(planner.plan(request(machine, several, site)).reason)
    recorded(told)


def test_steering(recorded, machine) -> None:
    planner, told = Dubins(DubinsSettings(), machine), []
    for goal in ((6.0, 3.0, 1.5), (-5.0, 0.0, 0.2)):
        path = planner.plan(request(machine, goal)).path
        assert path is not None
        rng = np.random.default_rng(4)
        for along_m in (0.0, 0.02, 1.0, 0.5 * path.length_m, path.length_m - 0.02, path.length_m):
            i = int(np.searchsorted(path.along_m, along_m).clip(0, len(path.along_m) - 1))
            x, y, yaw = path.poses_map[i] + rng.normal(0, 0.15, 3)
            T = pose(from_rpy(0, 0, yaw), np.array([x, y, 0.9]))
            told.append(planner.steer(path, along_m, T))
            for return_m, speed in ((1.0, 9.0), (4.0, 0.3)):
                told.append(Tracker(machine.driving, speed, return_m).steer(path, along_m, T))
    recorded(told)
