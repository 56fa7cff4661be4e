"""A site without physics: stones that jaws pick up and set down, and plugins that see them.

Everything of the executive is real: tree, leaves, database, journal. The robot keeps its state as
the simulated ones do, and counts what must not happen to a stone.
"""

import itertools

import numpy as np
from executive_plugins.motion.hermite import Hermite
from executive_plugins.robot.kinematic import KinematicRobot, KinematicSettings

from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.mapping import Mapper
from executive.interfaces.placing import PlacementPlanner
from executive.interfaces.robot import Robot
from executive.interfaces.segmentation import Segmenter
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.command import MoveJaws
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.placement import Placement, Slot
from executive.messages.request import MotionPlan
from executive.messages.segment import Segment, Segmentation
from executive.messages.trajectory import JointTrajectory

RADIUS_M = 0.4
STONES = np.array([[6.0, -1.5, RADIUS_M], [6.5, 0.5, RADIUS_M]])
SLOTS = np.array([[5.0, 3.0, 0.0], [6.5, 2.5, 0.0], [4.5, -3.0, 0.0]])
HOLD_RAD = 0.4
FALL_M = 0.3


class ToyRobot(KinematicRobot):
    """The machine without physics, and stones."""

    Settings = KinematicSettings

    def __init__(self, settings: KinematicSettings, machine: Machine) -> None:
        super().__init__(settings, machine)
        self.stones = STONES.copy()
        self.held = -1
        self.falls = 0

    def keep(self):
        own = {"stones": self.stones, "held": self.held, "falls": self.falls}
        return {**super().keep(), "site": own}

    def restore(self, kept):
        super().restore(kept)
        self.stones, self.held, self.falls = (kept["site"][k] for k in ("stones", "held", "falls"))

    def command(self, command):
        if isinstance(command, MoveJaws) and command.position_rad < self._jaw:
            near = np.linalg.norm(self.stones - self._between(), axis=1)
            is_stone = near.min() < RADIUS_M
            self._settings = self._settings.model_copy(
                update={"jaws_stop_at": HOLD_RAD if is_stone else 0.0}
            )
        super().command(command)

    def _between(self):
        T = self._T_map_base @ self._kinematics.gripper(self._q)
        return T[:3, 3] + T[:3, :3] @ self._machine.gripper.grasp_centre

    def _step(self):
        before = self._jaw
        observations = super()._step()
        at = self._between()
        if self.held < 0 and self._jaw <= HOLD_RAD + 1e-6 and before > HOLD_RAD + 1e-6:
            near = np.linalg.norm(self.stones - at, axis=1)
            self.held = int(near.argmin()) if near.min() < RADIUS_M else -1
        if self.held >= 0 and self._jaw > HOLD_RAD + 0.1:
            self.falls += int(self.stones[self.held][2] > RADIUS_M + FALL_M)
            self.stones[self.held][2] = RADIUS_M
            self.held = -1
        if self.held >= 0:
            self.stones[self.held] = at
        return observations


def surface(centre):
    """Return points on a ball [m], shape (200, 3)."""
    n = np.arange(200) + 0.5
    polar, azimuth = np.arccos(1 - 2 * n / 200), np.pi * (1 + 5**0.5) * n
    ball = [np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar), np.cos(polar)]
    return centre + RADIUS_M * np.array(ball).T


class ToyMap(Mapper):
    """Sees the stones that lie."""

    def __init__(self, settings, robot: Robot) -> None:
        self._robot = robot

    def cloud(self):
        robot = self._robot
        lying = [surface(one) for i, one in enumerate(robot.stones) if i != robot.held]
        grid = np.stack(np.meshgrid(np.arange(0, 9, 0.5), np.arange(-6, 6, 0.5)), -1).reshape(-1, 2)
        return Cloud("map", np.vstack([np.c_[grid, np.zeros(len(grid))], *lying]))

    def add_scan_pair(self, scans, motion):
        return 0

    def mask_held(self, radius_m):
        pass

    def remove_sphere(self, centre_map, radius_m):
        return 0

    def add_surface(self, points_map):
        pass

    def dense_share(self, sector, points_per_m2):
        return 1.0


class ToySegmenter(Segmenter):
    """Knows the stones of the map: all that is above the ground."""

    def __init__(self, settings) -> None:
        """Take no settings."""

    def segment(self, cloud):
        points = cloud.points[cloud.points[:, 2] > 1e-3]
        segments = []
        while len(points):
            near = np.linalg.norm((points - points[0])[:, :2], axis=1) < 2.2 * RADIUS_M
            own, points = points[near], points[~near]
            segments.append(Segment(len(segments), own, own.mean(axis=0), np.ptp(own, axis=0)))
        ground = Cloud("map", cloud.points[cloud.points[:, 2] <= 1e-3])
        return Segmentation("map", tuple(segments), ground, np.array([0.0, 0.0, 1.0, 0.0]))

    def merge(self, clouds):
        return clouds[0]


def above(centre, machine):
    """Return the pose of a gripper that points down at a centre, shape (4, 4)."""
    T = np.eye(4)
    T[:3, :3] = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    T[:3, 3] = centre - T[:3, :3] @ machine.gripper.grasp_centre
    return T


class ToyGrasps(GraspPlanner):
    """From above."""

    def __init__(self, settings, machine: Machine) -> None:
        self._machine = machine

    def plan(self, target, cloud, T_map_base, rng):
        T = above(target.centroid_map, self._machine)
        return GraspPlan((Grasp(T, 1.0, 1.0, {}), Grasp(T, 1.0, 0.5, {})), {})


class ToyPlaces(PlacementPlanner):
    """Three places."""

    def __init__(self, settings) -> None:
        """Take no settings."""

    def slots(self, segmentation, T_map_base, count, layout=None):
        return tuple(Slot(i + 1, place) for i, place in enumerate(SLOTS[:count]))

    def plan(self, stone, slot, T_map_gripper, cloud, T_map_base):
        T, T_object = T_map_gripper.copy(), stone.T_map_object.copy()
        shift = slot.position_map + [0, 0, RADIUS_M] - stone.centroid_map
        T[:3, 3] += shift
        T_object[:3, 3] += shift
        return (Placement(slot, T, T_object),)


class ToyMotion(Hermite):
    """Straight through the joints, up and over, at half of their speed."""

    def __init__(self, settings, machine: Machine) -> None:
        super().__init__(settings, machine)
        self._arm = Kinematics(machine)

    def move(self, request):
        up = request.T_map_gripper.copy()
        up[2, 3] = 2.5
        goals = [request.start]
        for T in ([up] if request.arrive_m else []) + [request.T_map_gripper]:
            q = self._ik.solve(np.linalg.inv(request.T_map_base) @ T, goals[-1], lambda q: True)
            if q is None:
                return MotionPlan(None, "out of reach", np.empty((0, 3)))
            goals.append(q)
        times, positions, velocities = [0.0], [request.start], [np.zeros(len(request.start))]
        for before, after in itertools.pairwise(goals):
            lasts_s = max(
                1.0, float((np.abs(after - before) / self._machine.max_velocity).max() * 4)
            )
            for u in np.linspace(0, 1, 11)[1:]:
                times.append(times[-1] + lasts_s / 10)
                positions.append(before + (after - before) * (3 * u**2 - 2 * u**3))
                velocities.append((after - before) * (6 * u - 6 * u**2) / lasts_s)
        names = self._machine.arm_names
        path = JointTrajectory(names, np.array(times), np.array(positions), np.array(velocities))
        return MotionPlan(path, "", np.empty((0, 3)))
