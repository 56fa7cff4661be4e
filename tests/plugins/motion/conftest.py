"""A site of which the truth is known, seen as noisy points,
and a judge of what the arm does there.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import fcl
import numpy as np
import pytest
from executive_plugins.motion.hermite import Hermite
from executive_plugins.motion.settings import HermiteSettings
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MoveRequest
from executive.messages.trajectory import JointTrajectory

DOWN = from_rpy(0.0, np.pi / 2, 0.0)
T_MAP_BASE = pose(from_rpy(0.01, -0.015, 0.4), np.array([2.0, -1.0, 0.9]))


@dataclass(frozen=True, eq=False)
class Boulder:
    """An ellipsoid with axes along the map's."""

    centre: Float
    radii: Float

    def depths(self, points_map: Float) -> Float:
        """Return about how deep points lie inside [m]."""
        return np.asarray(
            (1 - np.linalg.norm((points_map - self.centre) / self.radii, axis=-1))
            * self.radii.min()
        )

    def surface(self, rng: np.random.Generator) -> Float:
        """Return noisy points of its surface in the map, shape (N, 3)."""
        directions = rng.normal(size=(1500, 3))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        return np.asarray(self.centre + directions * self.radii + rng.normal(0, 0.01, (1500, 3)))


class Site:
    """Stones in a ring about the base, at least 2.2 m apart."""

    def __init__(
        self, machine: Machine, ring_m: tuple[float, float], size_m: float, seed: int
    ) -> None:
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
            if all(
                np.hypot(x - s.centre[0], y - s.centre[1]) > 2.2 * self._size_m for s in self.stones
            ):
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
        return self._request(
            start, goal, points, transform(inverse(T_map_gripper), self.clouds[stone])
        )

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


class Judge:
    """Looks at a trajectory in fine steps, with other means than the planner: Pinocchio, whole
    hulls, ellipsoids.
    """

    def __init__(self, machine: Machine, site: Site) -> None:
        self.machine, self.site = machine, site
        self.kinematics = Kinematics(machine)
        self._parts = [
            (name, shape.vertices, fcl.CollisionObject(_fcl_hull(shape.vertices)))
            for name, link in machine.links.items()
            for shape in link.shapes
        ]

    def deepest_in_site(
        self, request: MoveRequest, trajectory: JointTrajectory, but: int | None
    ) -> float:
        """Return how deep the arm goes into ground and stones [m], all but one stone."""
        deepest = -np.inf
        stones = [stone for i, stone in enumerate(self.site.stones) if i != but]
        for q in _fine(trajectory, 0.1):
            frames = self.kinematics.frames(q, request.jaw_rad)
            points = [
                transform(frames[name], _filled(v))
                for name, v, _ in self._parts
                if name in _carried(self.machine)
            ]
            points_map = transform(request.T_map_base, np.vstack(points))
            sunk = self.site.ground_height(*points_map[:, :2].T) - points_map[:, 2]
            deepest = max(
                [deepest, sunk.max(), *(stone.depths(points_map).max() for stone in stones)]
            )
        return float(deepest)

    def touches_itself(self, request: MoveRequest, trajectory: JointTrajectory) -> bool:
        """Tell whether links touch that must not."""
        forbidden = {frozenset(pair) for pair in self.machine.collision_pairs}
        for q in _fine(trajectory, 0.2):
            frames = self.kinematics.frames(q, request.jaw_rad)
            for name, _, part in self._parts:
                part.setTransform(fcl.Transform(frames[name][:3, :3], frames[name][:3, 3]))
            for i, (a, _, part_a) in enumerate(self._parts):
                for b, _, part_b in self._parts[:i]:
                    if frozenset((a, b)) in forbidden and fcl.collide(part_a, part_b):
                        return True
        return False


def _fcl_hull(vertices: Float) -> fcl.BVHModel:
    mesh = fcl.BVHModel()
    hull = ConvexHull(vertices)
    mesh.beginModel(len(vertices), len(hull.simplices))
    mesh.addSubModel(vertices, hull.simplices)
    mesh.endModel()
    return mesh


def _filled(vertices: Float) -> Float:
    """Return corners and points between any two of them."""
    i, j = np.triu_indices(len(vertices))
    return np.vstack([(1 - s) * vertices[i] + s * vertices[j] for s in (0.0, 0.25, 0.5, 0.75)])


def _carried(machine: Machine) -> set[str]:
    return set(machine.links) - {machine.base_link, machine.cabin_link}


def _fine(trajectory: JointTrajectory, step_s: float) -> Float:
    return np.array([trajectory.at(t)[0] for t in np.arange(0.0, trajectory.duration_s, step_s)])


@pytest.fixture(scope="session")
def make_site() -> type[Site]:
    return Site


@pytest.fixture(scope="session")
def make_judge() -> type[Judge]:
    return Judge


@pytest.fixture(scope="session")
def make_planner() -> Callable[[str], Hermite]:
    return started


@cache
def started(model: str) -> Hermite:
    """Return a planner that has been started, one a machine."""
    planner = Hermite(HermiteSettings(), load_machine(model))
    planner.start()
    return planner
