"""Stones on a field, as a planner sees them, and a motion planner for which every pose
is in reach.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from executive_plugins.grasping.sampled_antipodal import SampledAntipodal
from executive_plugins.grasping.settings import SampledAntipodalSettings

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.interfaces.motion import MotionPlanner
from executive.machine.gripper import Gripper
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.stone import Stone, StoneState


class FreeMotion(MotionPlanner):
    """Reaches everything within a distance of the base."""

    def __init__(self, reach_m: float = np.inf) -> None:
        self.reach_m = reach_m

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        return seed if np.linalg.norm(T_base_gripper[:2, 3]) <= self.reach_m else None

    def move(self, request: MoveRequest) -> MotionPlan:
        raise NotImplementedError

    def swing(self, start: Float, angle_rad: float, duration_s: float) -> MotionPlan:
        raise NotImplementedError


def box_surface(sides_m: tuple[float, float, float], spacing_m: float = 0.025) -> Float:
    """Return points on a box that stands on z = 0 about the z axis, without its underside, shape
    (N, 3).
    """
    x, y, z = (np.arange(-side / 2, side / 2 + 1e-9, spacing_m) for side in sides_m)
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    half = np.array([x[-1], y[-1], z[-1]])
    on_side = (np.abs(grid[:, :2]) > half[:2] - 1e-9).any(axis=1)
    points = grid[on_side | (grid[:, 2] > half[2] - 1e-9)]
    return np.asarray(points + (0.0, 0.0, sides_m[2] / 2))


def field(half_m: float = 4.0, spacing_m: float = 0.05, without: Float | None = None) -> Float:
    """Return level ground about the origin, without the square shadow (half side,) of a stone,
    shape (N, 3).
    """
    x = np.arange(-half_m, half_m, spacing_m)
    xy = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    if without is not None:
        xy = xy[(np.abs(xy) > without).any(axis=1)]
    return np.column_stack([xy, np.zeros(len(xy))])


def seen(stone: Float, around: Float, T: Float | None = None) -> tuple[Stone, Cloud]:
    """Return the stone and the whole cloud, moved by a pose."""
    T = np.eye(4) if T is None else T
    points = transform(T, stone)
    cloud = np.concatenate([points, transform(T, around)])
    return Stone(1, StoneState.ON_GROUND, points, points.mean(axis=0), T, True), Cloud("map", cloud)


@pytest.fixture(scope="session")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(scope="session")
def gripper(machine: Machine) -> Gripper:
    return machine.gripper


@pytest.fixture(scope="session")
def free_motion() -> MotionPlanner:
    return FreeMotion()


@pytest.fixture(scope="session")
def planner_of(machine: Machine) -> Callable[..., SampledAntipodal]:
    """Return a maker of planners by their settings and the arm's reach."""

    def make(reach_m: float = np.inf, **settings: Any) -> SampledAntipodal:
        return SampledAntipodal(SampledAntipodalSettings(**settings), machine, FreeMotion(reach_m))

    return make


@pytest.fixture(scope="session")
def make_box() -> Callable[..., Float]:
    return box_surface


@pytest.fixture(scope="session")
def make_field() -> Callable[..., Float]:
    return field


@pytest.fixture(scope="session")
def see() -> Callable[..., tuple[Stone, Cloud]]:
    return seen
