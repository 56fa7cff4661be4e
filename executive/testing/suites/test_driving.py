"""What every driving planner must do, whatever its method."""

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.interfaces.driving import DrivePlanner
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.drive import BasePath, DrivePlan
from executive.testing.exercises.driving import ahead, level_ground, standing
from executive.testing.pytest_plugin import Insist

CAPABILITY = "driving"
TICK_S = 0.05
THERE_M, THERE_RAD = 0.15, 0.05  # a tenth of what a site leaves as room for the arm


@pytest.fixture(autouse=True)
def _drives(machine: Machine) -> None:
    if machine.driving is None:
        pytest.skip(f"{machine.name} does not drive")


def _held(machine: Machine, plan: DrivePlan, insist: Insist) -> BasePath:
    """Check what holds for every path, and return it."""
    insist(plan.path is not None, f"it finds no way over level ground: {plan.reason}")
    path, limits = plan.path, machine.driving
    assert path is not None
    assert limits is not None
    assert np.abs(path.curvature_1_m).max() <= limits.max_curvature_1_m + 1e-9
    np.testing.assert_allclose(path.poses_map[0], 0.0, atol=1e-6)
    assert np.linalg.norm(np.diff(path.poses_map[:, :2], axis=0), axis=1).max() <= 0.5
    return path


@pytest.mark.parametrize("way_m", [8.0, -8.0])
def test_it_finds_a_way_over_level_ground(
    plugin: DrivePlanner, machine: Machine, insist: Insist, way_m: float
) -> None:
    path = _held(machine, plugin.plan(ahead(machine, way_m)), insist)
    np.testing.assert_allclose(path.goal_map[:2], [way_m, 0.0], atol=1e-6)


def test_a_wall_is_not_driven_through(plugin: DrivePlanner, machine: Machine) -> None:
    x, y, z = np.meshgrid(np.arange(9.0, 9.5, 0.1), np.arange(-25, 25, 0.1), np.arange(0, 2.5, 0.1))
    wall = np.c_[x.ravel(), y.ravel(), z.ravel()]
    ground = level_ground().points
    plan = plugin.plan(ahead(machine, 16.0, Cloud("map", np.vstack([ground, wall]))))
    assert plan.path is None
    assert plan.trouble is not None
    assert plan.reason


def test_ground_that_is_unseen_or_too_steep_is_refused(
    plugin: DrivePlanner, machine: Machine
) -> None:
    ground = level_ground().points
    near = ground[np.abs(ground).max(axis=1) < 6.0]
    steep = ground.copy()
    steep[:, 2] = np.maximum(ground[:, 0] - 6.0, 0.0)  # a slope of 45°
    for points in (near, steep):
        plan = plugin.plan(ahead(machine, 18.0, Cloud("map", points)))
        assert plan.path is None
        assert plan.reason


def test_steering_leads_to_the_end_and_stops_there(
    plugin: DrivePlanner, machine: Machine, insist: Insist
) -> None:
    path = _held(machine, plugin.plan(ahead(machine, 8.0)), insist)
    place, along_m = np.array([0.0, 0.2, 0.05]), 0.0  # beside the path at first
    for _ in range(round(120 / TICK_S)):
        T = pose(about_axis(np.array([0.0, 0.0, 1.0]), place[2]), np.append(place[:2], 0.9))
        steering = plugin.steer(path, along_m, T)
        along_m = steering.along_m
        if steering.left_m == 0.0:
            break
        way = steering.speed_m_s * TICK_S
        place = place + [
            way * np.cos(place[2]), way * np.sin(place[2]), way * steering.curvature_1_m
        ]  # fmt: skip
    assert steering.left_m == 0.0
    assert steering.speed_m_s == 0.0
    assert np.linalg.norm(place[:2] - path.goal_map[:2]) < THERE_M
    assert abs(place[2] - path.goal_map[2]) < THERE_RAD


def test_steering_keeps_the_limits_of_the_machine(plugin: DrivePlanner, machine: Machine) -> None:
    plan, limits = plugin.plan(ahead(machine, 8.0)), machine.driving
    if plan.path is None or limits is None:
        pytest.skip("it finds no way")
    for turned in (-1.0, 0.0, 1.0):
        T = standing(machine) @ pose(about_axis(np.array([0.0, 0.0, 1.0]), turned))
        steering = plugin.steer(plan.path, 1.0, T)
        assert abs(steering.speed_m_s) <= limits.max_speed_m_s
        assert abs(steering.curvature_1_m) <= limits.max_curvature_1_m + 1e-9
