"""Drive the machine to another place."""

from collections.abc import Iterator

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.config import Meters, Radians
from executive.geometry.rotation import wrap_angle, yaw_of
from executive.interfaces.declaration import MachineSettings, Refusal
from executive.interfaces.driving import DrivePlanner
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.drive import DriveSettings, drive, refused
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.posture import POSTURE_NEEDS, move_to_posture
from executive.leaf.region_name import RegionName
from executive.leaf.surroundings import surroundings
from executive.machine.machine import Machine
from executive.messages.drive import DriveRequest, DriveTrouble
from executive.messages.stone import StoneState

_THERE_M, _THERE_RAD = 0.15, 0.05  # from a goal, as the contract of driving planners asks
_DIRECTIONS = 8  # headings and sides that are tried where the heading is free


class MoveBaseSettings(DriveSettings, MachineSettings):
    place: tuple[Meters, Meters] | None = Field(
        None, examples=[["8 m", "0 m"]], description="Where to, x and y in the map [m]."
    )
    to: RegionName | None = Field(
        None, description="Region in whose middle the machine is to stand."
    )
    heading: Radians | None = Field(
        None,
        ge=-2 * np.pi,
        le=2 * np.pi,
        description="Heading there, from x towards y [rad]; any if not given, and the direction of "
        "the way first.",
    )
    distance: Meters | None = Field(
        None,
        gt=0,
        le=100,
        description="To a stone: distance of its centroid from the machine's middle [m]; 0.6 of "
        "the reach if not given.",
    )

    @model_validator(mode="after")
    def _check_goal(self) -> "MoveBaseSettings":
        if self.place is not None and self.to is not None:
            raise ValueError("give 'place' or 'to', not both")
        return self

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        if machine.driving is None:
            yield Refusal((), f"{machine.name} does not drive (driving of its robot.yaml)")


class MoveBase(Action[MoveBaseSettings]):
    """Drive to a place, to the middle of a region, or within reach of a stone.

    The arm is folded into the posture for driving first, and the jaws have to be empty. The way is
    planned on the map; without a `stone`, `place` or `to` names the goal.
    """

    needs = (*POSTURE_NEEDS, DrivePlanner)
    claims = (Part.ARM, Part.CABIN, Part.WHEELS)
    on_resume = OnResume.REDO

    def run(self, stone: int | None = None) -> Steps[None]:
        """Fold the arm, plan the way, and drive.

        Args:
            stone: Id of the stone that is to be in reach; then neither `place` nor `to` is given.
        """
        machine, context = self.context.machine(), self.context
        if problem := self._problem(machine, stone):
            return failed(problem, is_final=True)
        held = [s.id for s in context.use(ObjectDatabase).stones() if s.state is StoneState.HELD]
        if held:
            return failed(f"stone {held[0]} is held: put it down before driving", is_final=True)
        folded = yield from move_to_posture(context, self._folded(machine), None)
        if not folded.success:
            return refused(context, DriveTrouble.REFUSED, folded.reason)
        T_map_base = context.state().T_map_base
        goals = self._goals(stone, T_map_base)
        if _stands_at(goals, T_map_base):
            return succeeded(reason="the machine stands there already")
        request = DriveRequest(T_map_base, goals, (yield from surroundings(context)))
        plan = yield from context.job(context.use(DrivePlanner).plan, request)
        if plan.path is None:
            return refused(context, plan.trouble or DriveTrouble.REFUSED, plan.reason)
        return (yield from drive(context, plan.path, self.settings))

    def _problem(self, machine: Machine, stone: int | None) -> str:
        """Return what is wrong with the call; empty if nothing is."""
        if refusal := next(self.settings.refusals(machine), None):
            return refusal.message
        given = [self.settings.place is not None, self.settings.to is not None, stone is not None]
        if sum(given) != 1:
            return "give one goal: 'place', 'to', or the input 'stone'"
        return ""

    def _folded(self, machine: Machine) -> Float:
        posture = machine.driving.posture if machine.driving is not None else "scan"
        return machine.posture(posture)

    def _goals(self, stone: int | None, T_map_base: Float) -> Float:
        """Return the goals in order of preference: x, y and heading, shape (k, 3)."""
        start = T_map_base[:2, 3]
        if stone is not None:
            return self._around(self.context.use(ObjectDatabase).stone(stone).centroid_map, start)
        if self.settings.to is not None:
            place = self.context.region(self.settings.to).corners_map.mean(axis=0)
        else:
            place = np.array(self.settings.place)
        return np.array([[*place, heading] for heading in self._headings(place, T_map_base)])

    def _headings(self, place: Float, T_map_base: Float) -> list[float]:
        """Return the headings at a place: that of the way, the present one, then others."""
        if self.settings.heading is not None:
            return [self.settings.heading]
        way = place - T_map_base[:2, 3]
        ahead, now = float(np.arctan2(way[1], way[0])), yaw_of(T_map_base[:3, :3])
        others = np.arange(_DIRECTIONS) * 2 * np.pi / _DIRECTIONS
        return [ahead, now, *(ahead + others[1:]).tolist()]

    def _around(self, centroid_map: Float, start: Float) -> Float:
        """Return goals about a stone, the nearest first, each facing it or as `heading` says."""
        given_m = self.settings.distance
        away_m = _REACHED * self.context.machine().reach_m if given_m is None else given_m
        first = start - centroid_map[:2]
        angles = np.arctan2(first[1], first[0]) + _alternating(_DIRECTIONS)
        places = centroid_map[:2] + away_m * np.column_stack([np.cos(angles), np.sin(angles)])
        facing = angles + np.pi if self.settings.heading is None else 0 * angles
        if self.settings.heading is not None:
            facing = facing + self.settings.heading
        return np.column_stack([places, facing])


def _stands_at(goals: Float, T_map_base: Float) -> bool:
    """Return whether the chassis is as near to a goal (k, 3) as a drive brings it."""
    away_m = np.linalg.norm(goals[:, :2] - T_map_base[:2, 3], axis=1)
    turned = [abs(wrap_angle(yaw_of(T_map_base[:3, :3]) - goal[2])) for goal in goals]
    return bool(((away_m < _THERE_M) & (np.array(turned) < _THERE_RAD)).any())


_REACHED = 0.6  # of the reach: the middle of the sector in which sites lay their stones


def _alternating(count: int) -> Float:
    """Return angles around a circle, alternating to both sides of 0 [rad], shape (count,)."""
    steps = np.arange(count)
    signs = np.where(steps % 2 == 1, 1, -1)
    return np.asarray(signs * ((steps + 1) // 2) * 2 * np.pi / count)
