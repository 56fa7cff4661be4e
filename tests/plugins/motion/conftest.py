"""A site of which the truth is known: rolling ground and ellipsoidal stones, seen as noisy points."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy
from executive.messages.cloud import Cloud
from executive.messages.request import MoveRequest
from plugins.motion.hermite import Hermite, HermiteSettings
from robot_models.machine import Machine, load_machine

DOWN = from_rpy(0.0, np.pi / 2, 0.0)
T_MAP_BASE = pose(from_rpy(0.01, -0.015, 0.4), np.array([2.0, -1.0, 0.9]))


@dataclass(frozen=True, eq=False)
class Boulder:
    """An ellipsoid with axes along the map's."""

    centre: Float
    radii: Float

    def depths(self, points_map: Float) -> Float:
        """Return about how deep points lie inside [m]."""
        return np.asarray((1 - np.linalg.norm((points_map - self.centre) / self.radii, axis=-1)) * self.radii.min())

    def surface(self, rng: np.random.Generator) -> Float:
        """Return noisy points of its surface in the map, shape (N, 3)."""
        directions = rng.normal(size=(1500, 3))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        return np.asarray(self.centre + directions * self.radii + rng.normal(0, 0.01, (1500, 3)))


class Site:
    """Stones in a ring about the base, at least 2.2 m apart."""

    def __init__(self, machine: Machine, ring_m: tuple[float, float], size_m: float, seed: int) -> None:
        self.machine = machine
        self._ring_m, self._size_m = ring_m, size_m
        self.rng = np.random.default_rng(seed)
        self.stones: list[Boulder] = []
        while len(self.stones) < 5:
            radii = size_m * self.rng.uniform([0.35, 0.35, 0.3], [0.55, 0.55, 0.45])
            self.stones.append(Boulder(self._free_place(radii[2]), radii))
        self.clouds = [stone.surface(self.rng) for stone in self.stones]
        self.ground = self._ground_points()

    def ground_height(self, x: Float, y: Float) -> Float:
        """Return the ground's height in the map [m]."""
        return np.asarray(0.1 * np.sin(0.9 * x) + 0.08 * np.cos(0.7 * y))

    def _free_place(self, above_m: float) -> Float:
        while True:
            azimuth, radius = self.rng.uniform([-np.pi, self._ring_m[0]], [np.pi, self._ring_m[1]])
            x, y = T_MAP_BASE[:2, 3] + radius * np.array([np.cos(azimuth), np.sin(azimuth)])
            if all(np.hypot(x - s.centre[0], y - s.centre[1]) > 2.2 * self._size_m for s in self.stones):
                return np.array([x, y, self.ground_height(x, y) + above_m])

    def _ground_points(self) -> Float:
        xy = self.rng.uniform(-10, 10, (40000, 2))
        xy = xy[np.linalg.norm(xy, axis=1) > 2.5] + T_MAP_BASE[:2, 3]
        return np.c_[xy, self.ground_height(*xy.T) + self.rng.normal(0, 0.015, len(xy))]

    def pick(self, start: Float, stone: int, tilt_rad: float = 0.05) -> MoveRequest:
        """Ask for a grasp of a stone from above, its own points among the obstacles."""
        tilt = from_rpy(*self.rng.normal(0, tilt_rad, 2), self.rng.uniform(-np.pi, np.pi))
        palm = self.stones[stone].centre - tilt @ DOWN @ self.machine.gripper.grasp_centre
        points = np.vstack([self.ground, *self.clouds])
        return self._request(start, pose(tilt @ DOWN, palm), points, None)

    def place(self, start: Float, T_map_gripper: Float, stone: int) -> MoveRequest:
        """Ask to set a stone, held at a pose of the gripper, on free ground 5 cm above it."""
        place = self._free_place(self.stones[stone].radii[2] + 0.05)
        yaw = from_rpy(0.0, 0.0, self.rng.uniform(-np.pi, np.pi))
        R = yaw @ T_map_gripper[:3, :3]
        goal = pose(R, place + yaw @ (T_map_gripper[:3, 3] - self.stones[stone].centre))
        points = np.vstack([self.ground, *self.clouds[:stone], *self.clouds[stone + 1 :]])
        return self._request(start, goal, points, transform(inverse(T_map_gripper), self.clouds[stone]))

    def _request(self, start: Float, goal: Float, points: Float, held: Float | None) -> MoveRequest:
        open_rad = self.machine.gripper.open_rad
        return MoveRequest(
            start=start,
            T_map_gripper=goal,
            T_map_base=T_MAP_BASE,
            leave_m=0.8 * self._size_m,
            arrive_m=1.2 * self._size_m,
            obstacles=Cloud("map", points),
            held_gripper=held,
            jaw_rad=open_rad if held is None else 0.6 * open_rad,
        )


@pytest.fixture(scope="session")
def make_site() -> type[Site]:
    return Site


@pytest.fixture(scope="session")
def make_planner() -> Callable[[str], Hermite]:
    return started


@cache
def started(model: str) -> Hermite:
    """Return a planner that has been started, one a machine."""
    planner = Hermite(HermiteSettings(), load_machine(model))
    planner.start()
    return planner
