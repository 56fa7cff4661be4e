"""Look at a held stone from below."""

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Radians, Settings
from executive.events.stone import StoneSeenFromBelow
from executive.geometry.pose import inverse, transform
from executive.geometry.rotation import about_axis
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.follow import follow
from executive.leaf.lift_limit import too_heavy
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.resting import to_rest
from executive.leaf.sightings import is_underside_known
from executive.leaf.surroundings import held_kg, held_surface, surroundings
from executive.leaf.underside import Underside, with_underside
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.command import SwitchLidars
from executive.messages.hold import Hold
from executive.messages.request import MoveRequest
from executive.messages.trajectory import JointTrajectory

_UP = np.array([0.0, 0.0, 1.0])
_STEP_M = 0.5  # between the places from which the stone is shown
_TRIES = 8  # most ways that are planned
_A_TICK = 20  # places a tick whose reach is asked for: a millisecond each
_LEAVE_M = 0.3  # straight up at first: the stone hangs beside others


class SeeUndersideSettings(Settings):
    angle: Radians = Field(
        0.7,
        gt=0,
        le=1.5,
        description="Angle above the lidars' horizon at which the foot of the stone is wanted "
        "[rad]: the steeper, the more of it is seen. The arm raises it there, and no farther; "
        "where it cannot, to where it is seen most steeply.",
    )
    least_angle: Radians = Field(
        0.1,
        ge=0,
        le=1.5,
        description="A stone that can only be raised to less than this is not raised [rad]: of a "
        "side that is nearly level the lidars see nothing.",
    )
    turn: Radians = Field(
        2.6,
        ge=0,
        le=3.1,
        description="Angle by which the stone is turned on the way, so that its other side is seen "
        "too [rad]. The way turns by the shorter side, so that it is less than half a turn.",
    )
    least_seen: float = Field(
        0.5,
        ge=0,
        le=1,
        description="Least share of the columns of 0.1 m through the stone in which its lower half "
        "has to be seen; below that, the model is kept as it was.",
    )


@dataclass(frozen=True, slots=True)
class UndersideSeen:
    """What a look from below has shown.

    Attributes:
        underside_is_new: Whether the lower half of the stone's model has become what was seen of
            it, so that what was planned before was planned on another model.
    """

    underside_is_new: bool


class SeeUnderside(Action[SeeUndersideSettings]):
    """Raise a held stone above the lidars, turn it, and put what they see into its model.

    Of a stone on the ground the foot is not seen: its model ends a decimetre above the ground, or
    in points of the ground, and plans of structures guess the rest. The lidars' returns from below
    take the place of that. They are kept as they hang in the jaws: how the stone lies there is to
    be known before, by `SeeHeld`. Nothing is compared with the model, which does not show the side
    that is seen. Ours, not in the paper, whose stones are set down on free ground.

    A stone that was seen so before is not raised again. What could not be seen leaves the model as
    it was, which is no failure; a motion that does not come to its end is one.
    """

    needs = (Robot, Mapper, MotionPlanner, ObjectDatabase)
    claims = (Part.ARM, Part.CABIN, Part.LIDARS)
    on_resume = OnResume.REDO

    def run(self, hold: Hold) -> Steps[UndersideSeen]:
        """Raise, look, and replace the lower half of the model.

        Args:
            hold: Which stone is held, and how.
        """
        if is_underside_known(self.context.use(ObjectDatabase), hold.stone_id):
            told = f"the underside of stone {hold.stone_id} is known"
            return succeeded(UndersideSeen(False), told)
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        way, refused = yield from self._way(hold)
        if way is None:
            told = f"stone {hold.stone_id} was not seen from below: {refused}"
            return succeeded(UndersideSeen(False), told)
        risen = yield from self._shown(way)
        if not risen.success:
            return failed(risen.reason)
        view = yield from self.context.job(self.context.use(Mapper).held)
        underside = yield from self._merged(hold, view)
        is_new = underside.seen >= self.settings.least_seen
        self.context.record(
            StoneSeenFromBelow(
                stone=hold.stone_id,
                points=len(view),
                seen=underside.seen,
                raised_m=underside.raised_m,
                accepted=is_new,
            )
        )
        told = f"{underside.seen:.0%} of the lower half of stone {hold.stone_id} was seen"
        return succeeded(UndersideSeen(is_new), told)

    def _way(self, hold: Hold) -> Generator[Any, Any, tuple[JointTrajectory | None, str]]:
        """Return a way to where the stone is seen from below, or why there is none."""
        if not self.context.machine().sensors_of("lidar"):
            return None, "the machine has no lidar"
        surface, T_map_base = held_surface(self.context, hold), self.context.state().T_map_base
        stone = self.context.use(ObjectDatabase).stone(hold.stone_id)
        obstacles = yield from surroundings(self.context, hold.stone_id)
        motion, start = self.context.use(MotionPlanner), self.context.arm()
        refused, tries = "no place from which its foot would be seen is in reach", 0
        for number, goal in enumerate(self._places(surface, stone.reach_m), 1):
            if number % _A_TICK == 0:
                yield None
            if motion.reach(goal, start) is None:
                continue
            request = MoveRequest(
                start=start,
                T_map_gripper=T_map_base @ goal,
                T_map_base=T_map_base,
                leave_m=_LEAVE_M,
                arrive_m=0.0,
                obstacles=obstacles,
                held_gripper=surface,
                jaw_rad=hold.jaw_rad,
                held_kg=held_kg(self.context),
            )
            plan = yield from self.context.job(motion.move, request)
            heavy = too_heavy(self.context, plan, stone.mass_kg, "by_base")
            if plan.trajectory is not None and not heavy:
                return plan.trajectory, ""
            refused, tries = heavy or plan.reason, tries + 1
            if tries == _TRIES:
                break
        return None, refused

    def _places(self, surface: Float, reach_m: float) -> Iterator[Float]:
        """Return poses of the gripper over the chassis from which the foot is seen, best first.

        These are the nearest of those at which it is seen as is wanted, higher and nearer to the
        machine than now; then the others, by how steeply it is seen.
        """
        s, machine = self.settings, self.context.machine()
        T = inverse(self.context.state().T_map_base) @ self.context.gripper()
        lidar = _highest_lidar(machine, self.context.arm())
        foot_m = T[2, 3] + float((surface @ T[2, :3]).min())
        away_m = float(np.hypot(*T[:2, 3]))
        nearest_m = float(np.hypot(*lidar[:2])) + 2 * reach_m
        found = []
        for nearer_m in np.arange(0.0, max(away_m - nearest_m, 0.0) + _STEP_M / 2, _STEP_M):
            for up_m in np.arange(0.0, machine.reach_m, _STEP_M):
                aside_m = away_m - nearer_m - float(np.hypot(*lidar[:2]))
                angle = float(np.arctan2(foot_m + up_m - lidar[2], aside_m))
                if angle >= s.least_angle:
                    short_rad = max(s.angle - angle, 0.0)
                    found.append((short_rad, float(np.hypot(nearer_m, up_m)), nearer_m, up_m))
        for _, _, nearer_m, up_m in sorted(found):
            goal = T.copy()
            goal[:2, 3] *= 1.0 - nearer_m / away_m
            goal[2, 3] += up_m
            goal[:3, :3] = about_axis(_UP, s.turn) @ goal[:3, :3]
            yield goal

    def _shown(self, way: JointTrajectory) -> Steps[None]:
        """Follow the way with the lidars on."""
        robot = self.context.use(Robot)
        robot.command(SwitchLidars(True))
        try:
            return (yield from follow(self.context, way))
        finally:
            robot.command(SwitchLidars(False))

    def _merged(self, hold: Hold, view: Cloud) -> Generator[Any, Any, Underside]:
        """Put a view, in the gripper's frame, into the model, in the attitude at rest."""
        objects = self.context.use(ObjectDatabase)
        stone = objects.stone(hold.stone_id)
        T_rest_map = to_rest(stone, objects)
        model = transform(T_rest_map, stone.points_map)
        seen = transform(T_rest_map @ hold.T_map_gripper, view.points)
        underside: Underside = yield from self.context.job(with_underside, model, seen)
        if underside.seen >= self.settings.least_seen:
            points = transform(inverse(T_rest_map), underside.points)
            note = f"from below, {underside.seen:.0%} of its lower half"
            stone = objects.reshape(hold.stone_id, points, self.context.now_s(), note)
            T_now_then = self.context.gripper() @ inverse(hold.T_map_gripper)
            self.context.show("held", Cloud("map", transform(T_now_then, stone.points_map)))
        return underside


def _highest_lidar(machine: Machine, arm: Float) -> Float:
    """Return where the highest lidar is over the chassis [m], shape (3,)."""
    from executive.machine.kinematics import Kinematics  # reading a mission imports it not

    frames = Kinematics(machine).frames(arm)
    return max((frames[one.name][:3, 3] for one in machine.sensors_of("lidar")), key=lambda p: p[2])
