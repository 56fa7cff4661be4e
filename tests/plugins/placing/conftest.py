"""A motion planner with a plain idea of reach, level sites, and a held stone."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.placing.settings import SlotsSettings
from executive_plugins.placing.slots import Slots

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import Stone, StoneState

# A gripper that hangs: x down, its jaws open along y.
HANGING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])


class RingMotion(MotionPlanner):
    """Reaches what is not too near and not too far from the base."""

    def __init__(self, least_m: float, most_m: float) -> None:
        self.least_m, self.most_m = least_m, most_m

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        return seed if self.least_m <= np.hypot(*T_base_gripper[:2, 3]) <= self.most_m else None

    def move(self, request: MoveRequest) -> MotionPlan:
        raise NotImplementedError

    def swing(self, start: Float, angle_rad: float, duration_s: float) -> MotionPlan:
        raise NotImplementedError


def block(at: tuple[float, float], height_m: float = 0.6, half_m: float = 0.4) -> Float:
    """Return the surface of a block on level ground, without its underside, shape (N, 3)."""
    x = np.arange(-half_m, half_m + 1e-9, 0.05)
    grid = np.stack(
        np.meshgrid(x, x, np.arange(0.0, height_m + 1e-9, 0.05), indexing="ij"), axis=-1
    ).reshape(-1, 3)
    outside = (np.abs(grid[:, :2]) > half_m - 1e-6).any(axis=1) | (grid[:, 2] > height_m - 1e-6)
    return np.asarray(grid[outside] + (*at, 0.0))


def level_ground(half_m: float = 9.5, height_m: float = 0.0) -> Float:
    x = np.arange(-half_m, half_m, 0.1)
    xy = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.column_stack([xy, np.full(len(xy), height_m)])


def segmented(ground: Float, *stones: Float) -> Segmentation:
    segments = tuple(
        Segment(i, points, points.mean(axis=0), np.ones(3)) for i, points in enumerate(stones)
    )
    return Segmentation("map", segments, Cloud("map", ground), np.array([0.0, 0.0, 1.0, 0.0]))


def held(at: tuple[float, float]) -> tuple[Stone, Float]:
    """Return a block and the pose of the gripper at its grasp, straight above."""
    points = block(at)
    middle = points.mean(axis=0)
    stone = Stone(3, StoneState.HELD, points, middle, pose(t=middle), True)
    return stone, pose(HANGING, np.array([*at, 1.3]))


@pytest.fixture(scope="session")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(scope="session")
def planner_of(machine: Machine) -> Callable[..., Slots]:
    def make(reach_m: tuple[float, float] = (2.0, 9.0), **settings: object) -> Slots:
        return Slots(SlotsSettings.model_validate(settings), machine, RingMotion(*reach_m))

    return make


@pytest.fixture(scope="session")
def site() -> tuple[Callable, Callable, Callable, Callable]:
    """Return makers: of a block, of ground, of a segmentation, of a held stone."""
    return block, level_ground, segmented, held
