"""Plan the path to a grasp."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.events.stone import AttemptStarted, GraspRecord
from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_of_jaws
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.context import Context
from executive.leaf.leaning import leaning
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.site_success import expected_success
from executive.leaf.surroundings import surroundings
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.request import MoveRequest
from executive.messages.stone import Stone, StoneState
from executive.messages.trajectory import JointTrajectory

# Two grasps that are nearer than both count as one: about the spread of the jaws' own errors.
_ALIKE_M, _ALIKE_RAD = 0.1, 0.25


class PlanPickSettings(Settings):
    leave: Meters = Field(0.5, ge=0, le=5, description="Straight way up before travelling [m].")
    arrive: Meters = Field(
        1.2, ge=0, le=5, description="Straight way to the grasp along the ground's normal [m]."
    )
    least_success: float = Field(
        0.0,
        ge=0,
        le=1,
        description="Grasps are refused whose chance to place the stone is smaller, as expected "
        "after what came of the attempts before; 0: none is.",
    )


@dataclass(frozen=True, slots=True)
class GraspsLeft:
    """What is left of a plan.

    Attributes:
        grasps: Grasps for another attempt, best first.
    """

    grasps: list[Grasp]


@dataclass(frozen=True, slots=True)
class PickPlanned(GraspsLeft):
    """A grasp, and a collision-free path to it.

    Attributes:
        grasps: Grasps for another attempt, best first.
        grasp: The grasp that the path leads to.
        trajectory: The path to the grasp.
    """

    grasp: Grasp
    trajectory: JointTrajectory


@dataclass(frozen=True, slots=True)
class _Tried:
    """An attempt: when it began [s], T_object_gripper, and how often its grasp holds."""

    start_s: float
    T_object_gripper: Float
    hold_rate: float | None


class PlanPick(Action[PlanPickSettings]):
    """Find the first grasp with a collision-free path; remove it and those before it from the list.

    Grasps that differ from those that failed on the stone come first, because a stone that slipped
    out of a grasp slips out of it again. An attempt has failed if the stone has not been placed
    since. A machine on legs that yield leans with its arm: the path leads to where the grasp is
    once the arm is there.

    What came of all attempts on the site tells how likely the next one is to place its stone. The
    event `attempt_started` and the report have it, and `least_success` refuses by it.
    """

    needs = (MotionPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def __init__(self, settings: PlanPickSettings, context: Context) -> None:
        super().__init__(settings, context)
        self._tried: dict[int, list[_Tried]] = {}  # the attempts in order of time, by stone
        self._refusals: dict[int, str] = {}  # why the last plan found no path, by stone

    def run(self, stone: int, grasps: list[Grasp]) -> Steps[PickPlanned | GraspsLeft]:
        """Plan to one grasp after another.

        Args:
            stone: Id of the stone.
            grasps: Grasps of the stone, best first.
        """
        known = self.context.use(ObjectDatabase).stone(stone)
        if not grasps:
            before = self._refusals.get(stone, "those before were tried")
            return failed(f"no grasp of stone {stone} is left: {before}", GraspsLeft([]))
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        self._refusals.pop(stone, None)
        ordered = self._new_ones_first(known, grasps)
        cloud = yield from surroundings(self.context)
        motion = self.context.use(MotionPlanner)
        reasons: list[str] = []
        past = self._past()
        for number, grasp in enumerate(ordered, 1):
            success = _expected(grasp, past)
            if success is not None and success < self.settings.least_success:
                reasons.append(_unlikely(success, self.settings.least_success))
                continue
            T_map_base = yield from leaning(self.context, grasp.T_map_gripper)
            request = self._request(grasp, cloud, T_map_base)
            plan = yield from self.context.job(motion.move, request)
            if plan.trajectory is None:
                reasons.append(plan.reason)
                continue
            attempt = _Tried(self.context.now_s(), _on_stone(grasp, known), grasp.hold_rate)
            self._tried.setdefault(stone, []).append(attempt)
            self._record(known, grasp, reasons, success)
            self.context.show("path", plan)
            return succeeded(PickPlanned(ordered[number:], grasp, plan.trajectory))
        causes = "; ".join(sorted(set(reasons)))
        self._refusals[stone] = f"no path to any of {len(ordered)}: {causes}"
        return failed(f"stone {stone}: {self._refusals[stone]}", GraspsLeft([]))

    def _new_ones_first(self, stone: Stone, grasps: list[Grasp]) -> list[Grasp]:
        failed_ones = self._failed(stone)
        return sorted(
            grasps,
            key=lambda grasp: any(
                _are_alike(_on_stone(grasp, stone), other) for other in failed_ones
            ),
        )

    def _failed(self, stone: Stone) -> list[Float]:
        """Return the attempts that have failed since the stone was last placed."""
        placed_s = max(self._placed_s(stone.id), default=float("-inf"))
        tried = self._tried.get(stone.id, [])
        return [one.T_object_gripper for one in tried if one.start_s > placed_s]

    def _placed_s(self, stone: int) -> list[float]:
        """Return the times at which a stone was placed [s]."""
        history = self.context.use(ObjectDatabase).history(stone)
        return [event.stamp_s for event in history if event.state is StoneState.PLACED]

    def _past(self) -> list[tuple[float, bool]]:
        """Return how often the grasp of each attempt holds, and whether it led to a place.

        A stone that was released at its place, and has stood off it, was held all the same.
        """
        past: list[tuple[float, bool]] = []
        for stone, tried in self._tried.items():
            placed_s = self._placed_s(stone)
            ends_s = [*(one.start_s for one in tried[1:]), float("inf")]
            past += [
                (one.hold_rate, any(one.start_s < time_s <= end_s for time_s in placed_s))
                for one, end_s in zip(tried, ends_s, strict=True)
                if one.hold_rate is not None
            ]
        return past

    def _request(self, grasp: Grasp, cloud: Cloud, T_map_base: Float) -> MoveRequest:
        return MoveRequest(
            start=self.context.arm(),
            T_map_gripper=grasp.T_map_gripper,
            T_map_base=T_map_base,
            leave_m=self.settings.leave,
            arrive_m=self.settings.arrive,
            obstacles=cloud,
            held_gripper=None,
            jaw_rad=self.context.machine().gripper.open_rad,
        )

    def _record(
        self, stone: Stone, grasp: Grasp, passed_over: list[str], success: float | None
    ) -> None:
        record = GraspRecord(grasp.T_map_gripper, grasp.opening_m, grasp.score, dict(grasp.costs))
        self.context.record(
            AttemptStarted(stone.id, stone.centroid_map, record, tuple(passed_over), success)
        )
        self.context.show("grasp", grasp)


def _expected(grasp: Grasp, past: Sequence[tuple[float, bool]]) -> float | None:
    """Return the chance that an attempt with a grasp places its stone; None if nothing tells it."""
    return None if grasp.hold_rate is None else expected_success(grasp.hold_rate, past)


def _unlikely(success: float, least: float) -> str:
    return f"placed by it with {success:.0%}, and least_success asks for {least:.0%}"


def _on_stone(grasp: Grasp, stone: Stone) -> Float:
    return np.asarray(inverse(stone.T_map_object) @ grasp.T_map_gripper)


def _are_alike(T_a: Float, T_b: Float) -> bool:
    return (
        bool(np.linalg.norm(T_a[:3, 3] - T_b[:3, 3]) < _ALIKE_M)
        and angle_of_jaws(T_a[:3, :3], T_b[:3, :3]) < _ALIKE_RAD
    )
