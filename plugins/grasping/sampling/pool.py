"""The pool: all grasps of a stone that sampling finds (Mascaro 2020, Sec. 5.2 and 5.3).

Grasp planners rank the pool, and the making of labels draws its grasps from it.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from executive_plugins.grasping.sampling.closing import (
    Clearance,
    HoldOutcome,
    Hypotheses,
    push_and_close,
)
from executive_plugins.grasping.sampling.frames import downward_frames, local_frames, turned_frames
from executive_plugins.grasping.sampling.jaw_field import JawField, build_jaw_field
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud, build_planning_cloud
from executive_plugins.grasping.sampling.ranking import (
    SPREAD_M,
    SPREAD_RAD,
    first_alike,
    hold_costs,
    paper_costs,
)
from executive_plugins.grasping.sampling.settings import SamplingSettings

from executive.arrays import Float, Int
from executive.geometry.pose import inverse
from executive.geometry.voxels import compile_voxel_means
from executive.machine.gripper import Gripper

_CELL_M = 0.03  # cell of the tables of the gripper
_SKIN_M = 0.03  # the front map is enlarged by the positioning error of the arm
_TURN_Y_RAD, _TURN_Z_RAD = np.radians(60.0), np.radians(80.0)
# Offsets of approaches straight down from the stone's centre, along the width of the jaws and as
# shares of it.
_DOWNWARD_SHIFTS = (-0.25, 0.0, 0.25)


@dataclass(frozen=True, slots=True, eq=False)
class Pool:
    """M grasps that hold the stone and touch nothing else, in the frame of the planning cloud.

    Attributes:
        R: Orientations of the gripper, shape (M, 3, 3).
        position: Centres of the palm [m], shape (M, 3).
        jaw_rad: Jaw angle at which the first jaw touches [rad], shape (M,).
        costs: The costs of the paper and those of the hold, by name, each of shape (M,).
        refused: Number of refused hypotheses by reason.
        times_held: How often the stone was held so before, on the whole way to a place, shape (M,).
    """

    R: Float
    position: Float
    jaw_rad: Float
    costs: Mapping[str, Float]
    refused: Counter[str]
    times_held: Int

    def __len__(self) -> int:
        return len(self.R)

    def taken(self, index: Int) -> "Pool":
        """Return the grasps at some indices, in that order."""
        costs = {name: cost[index] for name, cost in self.costs.items()}
        parts = (self.R[index], self.position[index], self.jaw_rad[index])
        return Pool(*parts, costs, self.refused, self.times_held[index])


class Sampler:
    """Builds planning clouds and pools for one gripper."""

    def __init__(self, settings: SamplingSettings, gripper: Gripper) -> None:
        self._settings = settings
        self._gripper = gripper
        self._tables: JawField | None = None

    def prepare(self) -> None:
        """Tabulate the gripper and compile the loops, so that no plan waits for these seconds."""
        compile_voxel_means()
        point, nothing = np.zeros((1, 3)), np.zeros(1, dtype=bool)
        push_and_close(
            self._field(),
            point,
            ~nothing,
            point[0],
            Hypotheses(np.eye(3)[None], point, nothing),
            Clearance(0, 0, 0),
        )

    def scene(self, stone_map: Float, cloud_map: Float, rng: np.random.Generator) -> PlanningCloud:
        """Build the planning cloud of a stone, with a margin as wide as the gripper (Sec. 5.2)."""
        given_m = self._settings.into_soil_m
        into_soil_m = self._gripper.digs_m if given_m is None else self._settings.scale * given_m
        return self._scene(stone_map, cloud_map, rng, into_soil_m)

    def scenes(
        self, stone_map: Float, cloud_map: Float, rng: np.random.Generator
    ) -> list[PlanningCloud]:
        """Return the planning cloud, and that of grasps above the ground if they are wanted too."""
        found = [self.scene(stone_map, cloud_map, rng)]
        if self._settings.also_above_ground:
            found.append(self._scene(stone_map, cloud_map, rng, 0.0))
        return found

    def _scene(
        self, stone_map: Float, cloud_map: Float, rng: np.random.Generator, into_soil_m: float
    ) -> PlanningCloud:
        scale = self._settings.scale
        margin_m = -float(self._field().origin[1])  # half the width of the open gripper
        spacing_m = scale * self._settings.spacing_m
        return build_planning_cloud(
            stone_map, cloud_map, margin_m, spacing_m, rng, scale, into_soil_m
        )

    def pool(
        self, scene: PlanningCloud, rng: np.random.Generator, T_map_gripper: Float | None = None
    ) -> Pool:
        """Sample approaches, push and close each, and keep those that hold (Sec. 5.3).

        Args:
            scene: The planning cloud.
            rng: Draws the approaches.
            T_map_gripper: Grasps that have held the stone before, which are tried, too, ahead of
                the others, shape (K, 4, 4).
        """
        s, field = self._settings, self._field()
        sampled, too_steep = self._hypotheses(scene, rng)
        known, times = self._known(scene, T_map_gripper)
        tried = known.followed_by(sampled)
        times = np.concatenate([times, np.zeros(len(sampled.R), dtype=np.int64)])
        clearance = Clearance(
            *(
                s.scale * x
                for x in (s.stone_clearance_m, s.other_clearance_m, s.tips_below_centre_m)
            )
        )
        holds = push_and_close(field, scene.points, scene.is_target, scene.centre, tried, clearance)
        refused = Counter(
            {outcome.name.lower(): int((holds.outcome == outcome).sum()) for outcome in HoldOutcome}
        )
        del refused[HoldOutcome.HELD.name.lower()]
        refused["too_steep"] = too_steep
        held = np.flatnonzero(holds.outcome == HoldOutcome.HELD)
        R, position = tried.R[held], holds.position[held]
        costs = paper_costs(R, position, scene.centre, scene.ground.normal)
        costs |= hold_costs(field, holds, held, R, scene.centre)
        jaw_rad = field.jaw_rad[holds.progress[held].min(axis=1)]
        return Pool(R, position, jaw_rad, costs, refused, times[held])

    def _known(self, scene: PlanningCloud, T_map_gripper: Float | None) -> tuple[Hypotheses, Int]:
        """Return the approaches of grasps that held the stone, and how often, the newest first.

        Those that are alike are one. A stone that has turned since may lie so that one is too far
        off the vertical.
        """
        T_map = np.empty((0, 4, 4)) if T_map_gripper is None else T_map_gripper[::-1]
        T = inverse(scene.T_map_plan) @ T_map
        down = -T[:, :3, 0] @ scene.ground.normal
        T = T[down >= np.cos(self._settings.max_tilt_rad)]
        R, position, scale = T[:, :3, :3], T[:, :3, 3], self._settings.scale
        times = np.zeros(len(T), dtype=np.int64)
        for i in range(len(T)):
            times[first_alike(i, R, position, scale * SPREAD_M, SPREAD_RAD)] += 1
        newest = times > 0
        at = Hypotheses(R[newest], position[newest], np.zeros(int(newest.sum()), dtype=bool))
        return at, times[newest]

    def _hypotheses(self, scene: PlanningCloud, rng: np.random.Generator) -> tuple[Hypotheses, int]:
        """Return the approaches to try, and the number of those that were too far off the vertical.

        Approaches straight down are an addition to the paper: they are the nominal configuration of
        the arm of an excavator.
        """
        s, stone = self._settings, scene.stone
        at = stone[rng.choice(len(stone), min(s.samples, len(stone)), replace=False)]
        y = np.linspace(-_TURN_Y_RAD, _TURN_Y_RAD, s.turns_about_y)
        z = np.linspace(-_TURN_Z_RAD, _TURN_Z_RAD, s.turns_about_z)
        R = turned_frames(local_frames(stone, scene.normals, at, s.scale * s.frame_radius_m), y, z)
        anchor = np.repeat(at, len(y) * len(z), axis=0)
        level = -R[:, :, 0] @ scene.ground.normal >= np.cos(s.max_tilt_rad)
        # Half a turn suffices, since the jaws are symmetric.
        down = downward_frames(np.arange(s.downward_yaws) * np.pi / max(s.downward_yaws, 1))
        shifts = (
            self._gripper.jaw_width_m * np.array(_DOWNWARD_SHIFTS)[:, None, None] * down[:, :, 2]
        )
        down_anchor = (scene.centre + shifts).reshape(-1, 3)
        R_all = np.concatenate([R[level], np.tile(down, (len(shifts), 1, 1))])
        is_centred = np.arange(len(R_all)) >= level.sum()
        return Hypotheses(R_all, np.concatenate([anchor[level], down_anchor]), is_centred), int(
            (~level).sum()
        )

    def _field(self) -> JawField:
        # Tabulating takes a second, so it is not done at construction, which drawing a tree needs.
        if self._tables is None:
            self._tables = build_jaw_field(
                self._gripper, self._settings.scale * _CELL_M, self._settings.scale * _SKIN_M
            )
        return self._tables
