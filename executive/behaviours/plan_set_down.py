"""Plan to lower a held stone to the ground below it, or to free ground beside another stone."""

from collections.abc import Iterator

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import MetersPerSecond, Settings
from executive.geometry.gap import gap_below
from executive.geometry.pose import transform
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.context import Context
from executive.leaf.lift_limit import too_heavy
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.path import PathPlanned
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_kg, held_surface, surroundings
from executive.leaf.tool_way import slow_at_the_end, tool_way
from executive.leaf.turned import lower_by_m
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.stone import StoneState
from executive.messages.trajectory import JointTrajectory

_CLEARANCE_M = 0.05  # left between the stone and the ground: the model is a few centimetres off
_LEAST_WAY_M = 0.05
_GROUND_M = 0.15  # what is lower above the ground may be ground: three deviations of it and the map
# Beside other stones: a stone that stands on an edge falls over by some of its own thickness.
_ROOM_M = 0.3
_TOUCHING_M = 0.05  # as near to one another do the points of a model lie
_RING_M, _FARTHEST_M, _DIRECTIONS = 0.3, 2.4, 12  # of the places that are tried
_TRIES = 4  # motions that are planned: the stone slips meanwhile
# Half of what the joints brake with at a radius of 5 m; a sway doubles what brakes a load.
_BRAKING_M_S2, _SWAYS = 0.5, 2.0


class PlanSetDownSettings(Settings):
    speed: MetersPerSecond = Field(
        0.3,
        gt=0,
        le=2,
        description="Largest speed of the gripper where the stone may meet the ground, if it has "
        "turned about the tips [m/s]. The arm stops 0.3 s after the stone stands, and presses on "
        "it by the way that it goes meanwhile; a slower one gives it time to slip on.",
    )


class PlanSetDown(Action[PlanSetDownSettings]):
    """Plan the way down for a stone that slips, so that it falls less far.

    The way is fast as long as no part of the stone can meet the ground, and slow from there on:
    how a stone that slipped or turned lies in the jaws is not known. One that had turned by 53°
    stood 0.4 m earlier than its model; at 0.9 m/s the arm pressed on it with 14 t.

    It goes straight down where no other known stone is below, and otherwise to the nearest place
    beside it: set down on a stone that was placed, it would push that one away. If there is no such
    place in reach, or none to which a machine that may tip may carry the stone, it goes straight
    down all the same.
    """

    needs = (MotionPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, hold: Hold) -> Steps[PathPlanned]:
        """Plan from where the gripper is.

        Args:
            hold: Which stone is held, and how.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        cloud = yield from surroundings(self.context, hold.stone_id)
        surface = held_surface(self.context, hold)
        now = self.context.gripper()
        unseen_m = self._unseen_m(hold, surface, cloud) + _CLEARANCE_M
        if gap_below(transform(now, surface), cloud.points) - unseen_m < _LEAST_WAY_M:
            return failed("the stone is at the ground already")
        reason = ""
        for aside_m in self._places(hold.stone_id, transform(now, surface)):
            goal = now.copy()
            goal[:2, 3] += aside_m
            way_m = gap_below(transform(goal, surface), cloud.points) - unseen_m
            if way_m < _LEAST_WAY_M:
                continue
            goal[2, 3] -= way_m
            request = MoveRequest(
                start=self.context.arm(),
                T_map_gripper=goal,
                T_map_base=self.context.state().T_map_base,
                leave_m=0.0,
                arrive_m=way_m,
                obstacles=cloud,
                held_gripper=surface,
                jaw_rad=hold.jaw_rad,
                held_kg=held_kg(self.context),
            )
            plan = yield from self.context.job(self.context.use(MotionPlanner).move, request)
            if aside_m.any() and (heavy := self._too_heavy(plan, hold)):
                reason = reason or heavy
                continue
            if plan.trajectory is not None:
                way = self._slow(plan.trajectory, surface, now, hold)
                return succeeded(PathPlanned(way), _told(way_m, aside_m))
            reason = reason or plan.reason
        return failed(f"no path down: {reason}")

    def _unseen_m(self, hold: Hold, surface: Float, cloud: Cloud) -> float:
        """Return how far the stone reaches below what was seen of it [m], as it stood at the grasp.

        It is as much as may be taken for ground at most: a stone that stood on something else,
        which the map does not show, reaches no lower for that.
        """
        gap_m = gap_below(transform(hold.T_map_gripper, surface), cloud.points)
        return float(np.clip(gap_m, 0.0, _GROUND_M))

    def _too_heavy(self, plan: MotionPlan, hold: Hold) -> str:
        """Return why the stone may not be carried aside; straight down it is nowhere heavier."""
        stone = self.context.use(ObjectDatabase).stone(hold.stone_id)
        return too_heavy(self.context, plan, stone.mass_kg, "by_base")

    def _slow(
        self, way: JointTrajectory, surface: Float, T_map_gripper: Float, hold: Hold
    ) -> JointTrajectory:
        """Slow the way down where the stone may stand, however it has turned about the tips."""
        machine = self.context.machine()
        slow_m = lower_by_m(machine, hold.jaw_rad, surface, T_map_gripper)
        passed_m = tool_way(machine, way)
        sways = machine.stance.support_n_m is not None
        braking_m_s2 = _BRAKING_M_S2 / (_SWAYS if sways else 1.0)
        return slow_at_the_end(way, passed_m, slow_m, self.settings.speed, braking_m_s2)

    def _places(self, stone_id: int, held: Float) -> list[Float]:
        """Return where to set down, from the gripper [m], (2,) each, the nearest first."""
        straight = np.zeros(2)
        others = _others(self.context, stone_id)
        if not len(others):
            return [straight]
        from scipy.spatial import cKDTree  # reading a mission imports no algorithm

        tree = cKDTree(others)
        free = (
            aside
            for aside in _around()
            if tree.query(held[:, :2] + aside)[0].min() >= (_ROOM_M if aside.any() else _TOUCHING_M)
        )
        found = [place for place, _ in zip(free, range(_TRIES), strict=False)]
        if not found or found[0].any():
            return [*found, straight]
        return found[:1]


def _others(context: Context, stone_id: int) -> Float:
    """Return the points of all other known stones from above [m], shape (N, 2)."""
    stones = [
        stone.points_map[:, :2]
        for stone in context.use(ObjectDatabase).stones()
        if stone.id != stone_id and stone.state is not StoneState.LOST
    ]
    return np.vstack(stones) if stones else np.empty((0, 2))


def _around() -> Iterator[Float]:
    """Yield the place below, and then those of ever larger rings about it [m], (2,) each."""
    yield np.zeros(2)
    for radius_m in np.arange(_RING_M, _FARTHEST_M + 1e-9, _RING_M):
        for angle_rad in 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS:
            yield radius_m * np.array([np.cos(angle_rad), np.sin(angle_rad)])


def _told(way_m: float, aside_m: Float) -> str:
    beside = f", {np.linalg.norm(aside_m):.1f} m aside of another stone" if aside_m.any() else ""
    return f"{way_m:.2f} m down{beside}"
