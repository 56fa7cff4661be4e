"""Plan the way to a grasp."""

from typing import Any

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_between
from executive.leaf.action import Action, Steps
from executive.leaf.context import Context
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import surroundings
from executive.messages.grasp import Grasp
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.stone import Stone
from executive.messages.trajectory import JointTrajectory

_ALIKE_M, _ALIKE_RAD = (
    0.1,
    0.25,
)  # two grasps nearer than both are one: about the spread of the jaws' own errors


class PlanPickSettings(Settings):
    leave: Meters = Field(0.5, ge=0, le=5, description="Straight way up before travelling [m].")
    arrive: Meters = Field(
        1.2, ge=0, le=5, description="Straight way to the grasp along the ground's normal [m]."
    )


class PlanPick(Action):
    """Find the first grasp with a free way to it; it and those before it are taken off the list.

    Grasps unlike those that this node has tried on the stone before come first: what slipped once
    slips again.
    """

    Settings = PlanPickSettings
    needs = ("motion", "mapping", "objects")
    inputs = {
        "stone": Port(int, "id of the stone"),
        "grasps": Port(list[Grasp], "grasps, best first"),
    }
    outputs = {
        "grasp": Port(Grasp, "the grasp that the way leads to"),
        "grasps": Port(list[Grasp], "the grasps that are left for another try"),
        "trajectory": Port(JointTrajectory, "the way to the grasp"),
    }

    def __init__(self, settings: Any, context: Context) -> None:
        super().__init__(settings, context)
        self._tried: dict[int, list[Float]] = {}  # T_object_gripper by stone
        self._refusals: dict[
            int, str
        ] = {}  # why there was no way, by stone, when its grasps were last all refused

    def run(self, **inputs: Any) -> Steps:
        stone = self.context.plugin("objects").stone(inputs["stone"])
        if not inputs["grasps"]:
            before = self._refusals.get(stone.id, "those before were tried")
            return failed(f"no grasp of stone {stone.id} is left: {before}", grasps=[])
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        self._refusals.pop(stone.id, None)
        grasps = self._new_ones_first(stone, inputs["grasps"])
        cloud = surroundings(self.context)
        reasons = []
        for number, grasp in enumerate(grasps, 1):
            plan: MotionPlan = yield self.context.job("motion", "move", self._request(grasp, cloud))
            if plan.trajectory is None:
                reasons.append(plan.reason)
                continue
            self._tried.setdefault(stone.id, []).append(_on_stone(grasp, stone))
            self.context.note(
                "attempt",
                stone=stone.id,
                centroid_map=stone.centroid_map,
                grasp=_as_record(grasp),
                passed_over=reasons,
            )
            self.context.show("grasp", grasp)
            self.context.show("path", plan)
            return succeeded(grasp=grasp, grasps=grasps[number:], trajectory=plan.trajectory)
        self._refusals[stone.id] = (
            f"no way to any of {len(grasps)}: {'; '.join(sorted(set(reasons)))}"
        )
        return failed(f"stone {stone.id}: {self._refusals[stone.id]}", grasps=[])

    def _new_ones_first(self, stone: Stone, grasps: list[Grasp]) -> list[Grasp]:
        tried = self._tried.get(stone.id, [])
        return sorted(
            grasps,
            key=lambda grasp: any(_are_alike(_on_stone(grasp, stone), other) for other in tried),
        )

    def _request(self, grasp: Grasp, cloud: Any) -> MoveRequest:
        return MoveRequest(
            start=self.context.arm(),
            T_map_gripper=grasp.T_map_gripper,
            T_map_base=self.context.state().T_map_base,
            leave_m=self.settings.leave,
            arrive_m=self.settings.arrive,
            obstacles=cloud,
            held_gripper=None,
            jaw_rad=self.context.machine().gripper.open_rad,
        )


def _on_stone(grasp: Grasp, stone: Stone) -> Float:
    return np.asarray(inverse(stone.T_map_object) @ grasp.T_map_gripper)


def _are_alike(T_a: Float, T_b: Float) -> bool:
    return (
        bool(np.linalg.norm(T_a[:3, 3] - T_b[:3, 3]) < _ALIKE_M)
        and angle_between(T_a[:3, :3], T_b[:3, :3]) < _ALIKE_RAD
    )


def _as_record(grasp: Grasp) -> dict[str, Any]:
    return {
        "T_map_gripper": grasp.T_map_gripper,
        "opening_m": grasp.opening_m,
        "score": grasp.score,
        "costs": dict(grasp.costs),
    }
