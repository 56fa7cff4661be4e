"""Grasp planning by sampling: many approaches pushed until contact, closed, and ranked (Mascaro 2020, Sec. 5)."""

from collections import Counter
from collections.abc import Iterator
from typing import ClassVar

import numpy as np
from pydantic import Field

from executive.arrays import Float, checked
from executive.config import KilogramsPerCubicMeter, Meters, Radians, Settings
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.motion import MotionPlanner
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.stone import Stone
from plugins.grasping.arm_reach import ArmReach
from plugins.grasping.frames import downward_frames, local_frames, turned_frames
from plugins.grasping.jaw_field import JawField, build_jaw_field
from plugins.grasping.planning_cloud import PlanningCloud, build_planning_cloud
from plugins.grasping.push import Clearance, Holds, Hypotheses, Outcome, push_and_close
from plugins.grasping.ranking import Costs, hold_costs, paper_costs, ranked_rounds, spread
from plugins.grasping.rehearsal import FALLEN_M, Lifted, Rehearsal
from plugins.grasping.way_in import WayIn
from robot_models.machine import Machine

_CELL_M = 0.03  # of the gripper's tables
_SKIN_M = 0.03  # the front map is grown by this: the arm stands as precisely
_ROOM_IN_CLOUD_M = 0.01  # a point deeper than this in the open gripper refuses a grasp
_FEW_POINTS = 20  # fewer say nothing about a stone's shape
_TURN_Y_RAD, _TURN_Z_RAD = np.radians(60.0), np.radians(80.0)
_DOWNWARD_SHIFTS = (-0.25, 0.0, 0.25)  # of the jaws' width, along it, from the stone's centre
# Friction of steel on stone, and offsets in the gripper's frame [m]: as planned, and with margins for both.
_VARIANTS = ((0.45, (0.0, 0.0, 0.0)), (0.55, (-0.03, 0.0, 0.04)), (0.55, (-0.03, 0.0, -0.04)))
_PUSH_WEIGHT = 0.2  # of what the jaws move while they close, against what slips from them
_FIRM_M, _ENOUGH = 0.05, 4  # no more rehearsals when this many grasps cost less than this
_SPREAD_M, _SPREAD_RAD = 0.10, np.radians(20.0)


class SampledAntipodalSettings(Settings):
    """Density, sampling, clearance and ranking of the planner."""

    samples: int = Field(80, ge=1, le=5000, description="Points on the stone that approaches are made for.")
    turns_about_y: int = Field(5, ge=1, le=36, description="Rotations about a frame's y axis, over ±60°.")
    turns_about_z: int = Field(8, ge=1, le=36, description="Rotations about a frame's z axis, over ±80°.")
    downward_yaws: int = Field(36, ge=0, le=360, description="Yaws of the approaches straight down; 0 for none.")
    spacing_m: Meters = Field(0.04, gt=0, description="Density of the planning cloud [m].")
    frame_radius_m: Meters = Field(0.25, gt=0, description="Radius of the ball of a local frame (Eq. 4) [m].")
    max_tilt_rad: Radians = Field(0.7, gt=0, le=1.6, description="Largest angle of an approach off the vertical [rad].")
    stone_clearance_m: Meters = Field(0.04, ge=0, description="Room between palm or open jaws and the stone [m].")
    other_clearance_m: Meters = Field(0.02, ge=0, description="Room between the gripper and anything else [m].")
    tips_below_centre_m: Meters = Field(0.02, description="How far the tips close below the stone's centre [m].")
    way_in_m: Meters = Field(0.8, ge=0, description="Straight way down to a grasp that must be free and in reach [m].")
    density: KilogramsPerCubicMeter = Field(2700.0, gt=0, description="Density of a stone [kg/m³].")
    overload: float = Field(1.15, ge=1, description="Estimated mass over payload that is refused; a hull is too large.")
    keep_aligned: int = Field(40, ge=1, description="Grasps that pass the ranking by alignment (Sec. 5.4).")
    keep_enclosing: int = Field(20, ge=1, description="Grasps that pass the ranking by enclosing (Sec. 5.4).")
    rehearsed: int = Field(32, ge=0, le=500, description="Most lifts that are rehearsed; 0: the paper's order stays.")
    max_slip_m: Meters = Field(0.3, gt=0, description="A grasp whose stone moves more in rehearsals is refused [m].")
    max_grasps: int = Field(8, ge=1, description="Most grasps that are returned.")


class SampledAntipodal(GraspPlanner):
    """Samples approaches on the stone, and straight down onto it; keeps what holds it, hits nothing and is in reach.

    The approaches straight down are an addition to the paper: they are the nominal configuration of an excavator's arm.
    """

    Settings: ClassVar[type[Settings]] = SampledAntipodalSettings
    latency_s: ClassVar[dict[str, float]] = {"plan": 1.5}

    def __init__(self, settings: SampledAntipodalSettings, machine: Machine, motion: MotionPlanner) -> None:
        self._settings = settings
        self._machine = machine
        self._arm = ArmReach(machine, motion)
        self._field: JawField | None = None

    def plan(self, target: Stone, cloud: Cloud, T_map_base: Float, rng: np.random.Generator) -> GraspPlan:
        """Plan grasps, best first; empty with reasons if the stone cannot be held.

        Raises:
            DataError: If the cloud is not in the map.
        """
        if cloud.frame != "map":
            raise DataError(f"the grasp planner needs a cloud in the frame 'map', got '{cloud.frame}'")
        if len(target.points_map) < _FEW_POINTS:
            return GraspPlan((), {"too_few_points": 1})
        s, field = self._settings, self._jaw_field()
        margin_m = -float(field.origin[1])  # the open gripper's width (Sec. 5.2), half of it to either side
        scene = build_planning_cloud(target.points_map, cloud.points, margin_m, s.spacing_m, rng)
        if scene.volume_m3 * s.density > s.overload * self._machine.payload_kg:
            return GraspPlan((), {"too_heavy": 1})
        tried, too_steep = self._hypotheses(scene, rng)
        clearance = Clearance(s.stone_clearance_m, s.other_clearance_m, s.tips_below_centre_m)
        holds = push_and_close(field, scene.points, scene.is_target, scene.centre, tried, clearance)
        refused = Counter({outcome.name.lower(): int((holds.outcome == outcome).sum()) for outcome in Outcome})
        held = refused.pop(Outcome.HELD.name.lower())
        refused["too_steep"] = too_steep
        grasps = self._chosen(scene, tried, holds, checked("T_map_base", T_map_base, 4, 4), refused) if held else ()
        return GraspPlan(grasps, {reason: n for reason, n in sorted(refused.items()) if n})

    def _hypotheses(self, scene: PlanningCloud, rng: np.random.Generator) -> tuple[Hypotheses, int]:
        """Return the approaches to try (Sec. 5.3), and how many more were too far off the vertical."""
        s, stone = self._settings, scene.stone
        at = stone[rng.choice(len(stone), min(s.samples, len(stone)), replace=False)]
        y = np.linspace(-_TURN_Y_RAD, _TURN_Y_RAD, s.turns_about_y)
        z = np.linspace(-_TURN_Z_RAD, _TURN_Z_RAD, s.turns_about_z)
        R = turned_frames(local_frames(stone, scene.normals, at, s.frame_radius_m), y, z)
        anchor = np.repeat(at, len(y) * len(z), axis=0)
        level = -R[:, :, 0] @ scene.ground.normal >= np.cos(s.max_tilt_rad)
        down = downward_frames(np.arange(s.downward_yaws) * np.pi / max(s.downward_yaws, 1))  # the jaws are alike
        shifts = self._machine.gripper.jaw_width_m * np.array(_DOWNWARD_SHIFTS)[:, None, None] * down[:, :, 2]
        down_anchor = (scene.centre + shifts).reshape(-1, 3)
        R_all = np.concatenate([R[level], np.tile(down, (len(shifts), 1, 1))])
        is_centred = np.arange(len(R_all)) >= level.sum()
        return Hypotheses(R_all, np.concatenate([anchor[level], down_anchor]), is_centred), int((~level).sum())

    def _chosen(
        self, scene: PlanningCloud, tried: Hypotheses, holds: Holds, T_map_base: Float, refused: Counter[str]
    ) -> tuple[Grasp, ...]:
        """Rank what holds (Sec. 5.4), rehearse the best that the arm comes to, and rank those by how far they slip."""
        s, gripper = self._settings, self._machine.gripper
        held = np.flatnonzero(holds.outcome == Outcome.HELD)
        R, position = tried.R[held], holds.position[held]
        costs = paper_costs(R, position, scene.centre, scene.ground.normal)
        costs |= hold_costs(self._jaw_field(), holds, held, R, scene.centre)
        jaw_rad = self._jaw_field().jaw_rad[holds.progress[held].min(axis=1)]
        rehearsal = Rehearsal(gripper, scene.body, scene.ground.normal, scene.volume_m3 * s.density)
        grasps: list[Grasp] = []
        for i, T_map_gripper in self._attainable(scene, costs, R, position, T_map_base, refused):
            lifted = self._rehearsed(rehearsal, pose(R[i], position[i]), float(jaw_rad[i]))
            cost = lifted.get("slip_m", 0.0) + _PUSH_WEIGHT * lifted.get("push_m", 0.0)
            named = {name: float(cost[i]) for name, cost in costs.items()} | lifted
            grasps.append(Grasp(T_map_gripper, gripper.max_opening_m, -round(cost, 2), named))
            firm = sum(grasp.score >= -_FIRM_M for grasp in grasps)
            if firm == _ENOUGH or len(grasps) == max(s.rehearsed, s.max_grasps):
                break
        refused["slips"] = sum(grasp.score < -s.max_slip_m for grasp in grasps)
        grasps = [grasp for grasp in grasps if grasp.score >= -s.max_slip_m]
        grasps.sort(key=lambda grasp: -grasp.score)  # stable: equals keep the paper's order
        return tuple(grasps[: s.max_grasps])

    def _attainable(
        self, scene: PlanningCloud, costs: Costs, R: Float, position: Float, T_map_base: Float, refused: Counter[str]
    ) -> Iterator[tuple[int, Float]]:
        """Yield index and T_map_gripper of grasps with a free way in that the arm comes to, in the paper's order.

        When the grasps that pass the paper's stages are used up, those that are left go through the stages again.
        """
        s, up = self._settings, scene.ground.normal
        stages = [("align_rad", s.keep_aligned), ("enclose_m", s.keep_enclosing)]
        way_in = WayIn(self._machine.gripper)
        order = (int(i) for passed in ranked_rounds(costs, stages, "distance_m") for i in passed)
        for i in spread(order, R, position, _SPREAD_M, _SPREAD_RAD):
            T_plan_gripper = pose(R[i], position[i])
            T_map_gripper = self._arm.reached(scene.T_map_plan @ T_plan_gripper, T_map_base, s.way_in_m)
            if T_map_gripper is None:
                refused["out_of_reach"] += 1
            elif not way_in.is_free(scene.points, T_plan_gripper, up, s.way_in_m, _ROOM_IN_CLOUD_M):
                refused["way_in_blocked"] += 1
            else:
                yield i, T_map_gripper

    def _rehearsed(self, rehearsal: Rehearsal, T_plan_gripper: Float, jaw_rad: float) -> dict[str, float]:
        """Return `slip_m`, how far the stone moves in the jaws, and `push_m`, how far they move it before.

        Both are means over rehearsals at and about the pose.
        """
        if not self._settings.rehearsed:
            return {}
        lifts: list[Lifted] = []
        for friction, offset in _VARIANTS:
            lifts.append(rehearsal.lift(T_plan_gripper @ pose(t=np.array(offset)), jaw_rad, friction))
            if lifts[0].slip_m >= FALLEN_M:
                break  # hopeless: spare the variants
        slip_m, push_m = (float(np.mean(values)) for values in zip(*((x.slip_m, x.drag_m) for x in lifts), strict=True))
        return {"slip_m": slip_m, "push_m": push_m}

    def _jaw_field(self) -> JawField:
        if self._field is None:  # a second of work that only a mission that grasps needs
            self._field = build_jaw_field(self._machine.gripper, _CELL_M, _SKIN_M)
        return self._field
