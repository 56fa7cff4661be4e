"""Move along a planned trajectory."""

from collections.abc import Generator

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Settings
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.follow import follow, position_of
from executive.leaf.free_motion import FreeMotion
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed
from executive.leaf.rest import come_to_rest
from executive.leaf.rest_of_path import rest_of
from executive.leaf.surroundings import held_stone
from executive.leaf.way_back import way_back
from executive.messages.command import SwitchLidars
from executive.messages.trajectory import JointTrajectory


class ExecuteTrajectorySettings(Settings):
    scan: bool = Field(
        False, description="Whether the lidars are on while the machine moves, and off afterwards."
    )


class ExecuteTrajectory(Action[ExecuteTrajectorySettings]):
    """Follow a trajectory to its end; when cancelled, the machine stops along the path.

    With `scan` the map is filled meanwhile, so that a look needs no motion of its own. An arm that
    holds no stone stops, and the leaf fails, once it presses on something or lifts something; what
    it has lifted is lowered along the same path.
    """

    needs = (Robot, ObjectDatabase)
    claims = (Part.ARM, Part.CABIN, Part.LIDARS)
    on_resume = OnResume.VERIFY

    def run(self, trajectory: JointTrajectory) -> Steps[None]:
        """Follow the trajectory.

        Args:
            trajectory: Joint positions over time.
        """
        return (yield from self._follow(trajectory))

    def verify(self, trajectory: JointTrajectory) -> Steps[None]:
        """Go on along a trajectory that was cut off, from where the arm came to rest on it.

        Fails, so that the tree plans again, if the arm is not on the path.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        rest = rest_of(trajectory, position_of(self.context, trajectory))
        if rest is None:
            return failed("the arm left its path when the run was cut off: plan again")
        return (yield from self._follow(rest))

    def _follow(self, trajectory: JointTrajectory) -> Generator[None, None, Outcome[None]]:
        moving = follow(self.context, trajectory)
        if held_stone(self.context) is None:
            moving = self._freely(moving, trajectory)
        if not self.settings.scan:
            return (yield from moving)
        robot = self.context.use(Robot)
        robot.command(SwitchLidars(True))
        try:
            return (yield from moving)
        finally:
            robot.command(SwitchLidars(False))

    def _freely(
        self, moving: Generator[None, None, Outcome[None]], trajectory: JointTrajectory
    ) -> Generator[None, None, Outcome[None]]:
        """Follow a path that is expected to be free, and lower what the arm lifts all the same."""
        free = FreeMotion(self.context, trajectory)
        outcome = yield from free.watched(moving)
        if free.lifts and not (yield from come_to_rest(self.context)):
            yield from way_back(self.context, self._passed(trajectory)[::-1])
        return outcome

    def _passed(self, trajectory: JointTrajectory) -> Float:
        """Return the postures of the whole arm on a path up to where it is now, shape (m, n)."""
        arm, names = self.context.arm(), self.context.machine().arm_names
        away = np.abs(trajectory.position - position_of(self.context, trajectory)).max(axis=1)
        passed = trajectory.position[: max(int(away.argmin()), 1)]
        postures = np.tile(arm, (len(passed), 1))
        postures[:, [names.index(name) for name in trajectory.names]] = passed
        return postures
