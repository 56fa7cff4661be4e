"""Stand-ins for the capabilities that a plugin under test is given: small, fast, deterministic."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from executive.arrays import Float
from executive.interfaces.facilities import Photographer, Scene
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.plugin import Plugin
from executive.interfaces.robot import Robot
from executive.messages.command import Command
from executive.messages.observation import Observation
from executive.messages.request import Around, MotionPlan, MoveRequest

BOULDERS = np.array([[5.0, 1.0, 0.2, 0.6], [3.0, -3.0, 0.2, 0.5], [7.0, -1.0, 0.2, 0.55]])


class FreeMotion(MotionPlanner):
    """Reaches every pose at once, and refuses to plan a path: no planner of grasps needs one."""

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        return seed

    def move(self, request: MoveRequest) -> MotionPlan:
        return MotionPlan(None, "the stand-in plans no paths", np.empty((0, 3)))

    def swing(
        self, start: Float, angle_rad: float, duration_s: float, around: Around | None = None
    ) -> MotionPlan:
        return MotionPlan(None, "the stand-in plans no paths", np.empty((0, 3)))


class StillSite(Robot, Scene, Photographer):
    """A robot that stands still and measures nothing, on level ground with three round boulders."""

    def read(self, until_s: float) -> Sequence[Observation]:
        return ()

    def command(self, command: Command) -> None:
        """Take no notice: the machine stands still."""

    def resume(self) -> None:
        """Do nothing: no path is under way."""

    def stop(self) -> None:
        """Do nothing: the machine is at rest."""

    def safe_stop(self, reason: str) -> None:
        """Do nothing: the machine is at rest, and no command moves it."""

    def reset(self) -> None:
        """Do nothing: no safe stop is latched."""

    def latched(self) -> str:
        """Return that commands are taken."""
        return ""

    def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
        """Return the range [m] to the ground z = 0 or to a boulder, shape (N,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ranges = -origins_world[:, 2] / directions_world[:, 2]
        ranges = np.where(np.isfinite(ranges) & (ranges > 0), ranges, np.inf)
        for *centre, radius in BOULDERS:
            offset = origins_world - np.array(centre)
            half_b = np.einsum("ij,ij->i", offset, directions_world)
            root = half_b**2 - np.einsum("ij,ij->i", offset, offset) + radius**2
            near = -half_b - np.sqrt(np.maximum(root, 0.0))
            ranges = np.where((root > 0) & (near > 0), np.minimum(ranges, near), ranges)
        return np.asarray(ranges)

    def photograph(
        self, T_world_opticals: Sequence[Float], size_px: tuple[int, int], view_angle_rad: float
    ) -> Iterator[NDArray[np.uint8]]:
        """Yield grey pictures: no method can make a map of them, and each must say so."""
        for _ in T_world_opticals:
            yield np.full((size_px[1], size_px[0], 3), 128, np.uint8)


STAND_INS: Mapping[str, type[Plugin]] = {"motion": FreeMotion, "robot": StillSite}
