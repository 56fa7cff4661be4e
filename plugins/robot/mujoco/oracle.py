"""The truth about a simulated run: poses of stones, collisions, and errors of estimates."""

from collections.abc import Mapping, Sequence

import numpy as np
from executive_plugins.robot.mujoco.machine.legs import Legs
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.site.terrain import TERRAIN
from executive_plugins.robot.mujoco.truth.contact_log import Span
from executive_plugins.robot.mujoco.truth.standing import as_built, stones_over
from executive_plugins.robot.mujoco.truth.surface import TrueSurface
from executive_plugins.robot.mujoco.truth.touching import touching
from executive_plugins.robot.mujoco.truth.tracking import Tracking
from executive_plugins.robot.mujoco.truth.truth_log import TruthLog

from executive.arrays import Float
from executive.geometry.polygon import outline_of
from executive.geometry.pose import transform
from executive.geometry.rotation import angle_between
from executive.interfaces.oracle import Attempt, MissionView, Oracle
from executive.interfaces.robot import Robot
from executive.interfaces.truth import (
    AngleErrors,
    Collision,
    EstimateErrors,
    MapErrors,
    Nothing,
    PositionErrors,
    RegistrationErrors,
    Stance,
    TrueGrasp,
    TrueStone,
    TrueStructure,
    Truth,
)
from executive.messages.base_state import BaseState
from executive.messages.building import AsBuilt
from executive.messages.cloud import Cloud
from executive.messages.structure import Structure

_LIFTED_M = 0.15  # rise from which a stone counts as lifted
_DROPPED_M = 0.15  # fall from which a stone counts as dropped; releases are lower
# Distance from the palm beyond that at the top: below the first a stone is held, above the second
# it is released.
_HELD_M, _RELEASED_M = 0.05, 0.2
_AFTERMATH_S = 2.0  # a fall may begin shortly after the mission has reported it
_NONE: Float = np.zeros(0)


class MujocoOracle(Oracle):
    """Reads the truth log of a simulated robot."""

    def __init__(self, robot: Robot) -> None:
        if not isinstance(robot, MujocoRobot):
            raise TypeError(f"the oracle of the simulated robot was given a {type(robot).__name__}")
        self._log, self._limits = robot.truth_log, robot.limit_log
        self._site, self._scenario = robot.world.site, robot.world.scenario
        self._legs = robot.world.legs
        self._hand = {robot.world.machine.gripper_link, *robot.world.machine.gripper.links}

    def truth(self, view: MissionView) -> Truth:
        """Return what really happened.

        Contacts of gripper or jaws with the ground are counted and are no collisions, since the
        jaws close around a stone that lies on it.
        """
        tracking = Tracking(self._log, view.histories or {})
        targets = [(attempt.started_s, self._nearest(attempt)) for attempt in view.attempts]
        left_s = {i: one.ended_s for one, (_, i) in zip(view.attempts, targets, strict=True)}
        spans = self._log.spans()
        return Truth(
            scenario=self._scenario,
            stance=_stance(self._legs),
            stones=self._stones(view, tracking),
            grasps=tuple(
                self._grasp(view.attempts, i, target) for i, (_, target) in enumerate(targets)
            ),
            collisions=tuple(
                _as_report(span) for span in spans if self._is_collision(span, targets)
            ),
            ground_contacts=sum(
                span.link in self._hand and span.other == TERRAIN for span in spans
            ),
            estimate=_estimate(view.states, self._log),
            objects=Nothing() if view.histories is None else tracking.objects(),
            realignments=tracking.realignments(),
            map=self._map(view.map_cloud),
            registration=self._registration(view.registered_survey),
            limits=self._limits.found(),
            structures=tuple(self._structure(one, left_s) for one in view.structures),
        )

    def as_built(self, structure: Structure) -> AsBuilt | None:
        """Return a structure with the stones over its foot at the end, and those they touch."""
        return as_built(structure, self._site, self._at_end())

    def _structure(self, structure: Structure, left_s: Mapping[int, float]) -> TrueStructure:
        """Return the stones that stand, and how far they moved since they were left alone [s]."""
        at_end = self._at_end()
        stones = stones_over(structure, at_end)
        moved = [
            at_end[i][:3, 3] - self._log.T_world_stone(i, left_s[i])[:3, 3]
            for i in stones
            if i in left_s
        ]
        return TrueStructure(
            name=structure.name,
            stones=tuple(i + 1 for i in stones),
            T_map_stones=tuple(at_end[i] for i in stones),
            moved_m=tuple(float(np.linalg.norm(one)) for one in moved),
        )

    def _map(self, cloud: Cloud | None) -> Nothing | MapErrors:
        if cloud is None:
            return Nothing()
        return TrueSurface(self._site, self._log, self._log.end_s).distances(cloud.points)

    def _registration(self, survey: Cloud | None) -> Nothing | RegistrationErrors:
        if survey is None:
            return Nothing()
        # The surface at the begin is the one that the survey saw.
        return TrueSurface(self._site, self._log, 0.0).misplacement(survey.points)

    def _nearest(self, attempt: Attempt) -> int:
        """Return the index of the stone that an attempt was for, by true centroids.

        It is −1 if there is no stone.
        """
        distances = np.linalg.norm(
            self._log.centroids(attempt.started_s) - attempt.grasp_centroid_map, axis=1
        )
        return int(np.argmin(distances)) if len(distances) else -1

    def _stones(self, view: MissionView, tracking: Tracking) -> tuple[TrueStone, ...]:
        touched = touching(self._site, self._at_end())
        return tuple(
            self._stone(i, view, tracking, touched[i]) for i in range(len(self._log.stones))
        )

    def _at_end(self) -> list[Float]:
        """Return the pose of each stone at the end, (4, 4) each."""
        return [self._log.T_world_stone(i, self._log.end_s) for i in range(len(self._log.stones))]

    def _stone(
        self, i: int, view: MissionView, tracking: Tracking, touches: tuple[str, ...]
    ) -> TrueStone:
        """Return a stone as it lies at the end, and how the mission knows it."""
        model, T_end = self._site.stones[i], self._log.T_world_stone(i, self._log.end_s)
        corners = transform(T_end, model.hull)
        number = tracking.found_as(i)
        slot = None if number is None else view.slots.get(number)
        known = next((stone for stone in view.stones if stone.id == number), None)
        error = None if known is None else tracking.error(known.id, known.T_map_object)
        return TrueStone(
            id=i + 1,
            held_object=number,
            slot_error_m=(
                None
                if slot is None
                else float(np.linalg.norm(T_end[:2, 3] - slot.position_map[:2]))
            ),
            database_error_m=None if error is None else error.away_m,
            database_error_rad=None if error is None else error.away_rad,
            models=0 if error is None else error.models,
            volume_m3=model.volume_m3,
            centre_m=T_end[:3, 3],
            outline_m=outline_of(corners),
            bottom_m=float(corners[:, 2].min()),
            top_m=float(corners[:, 2].max()),
            touches=touches,
        )

    def _grasp(self, attempts: Sequence[Attempt], i: int, target: int) -> TrueGrasp:
        attempt = attempts[i]
        until_s = attempt.ended_s + _AFTERMATH_S
        if i + 1 < len(attempts):
            until_s = min(until_s, attempts[i + 1].started_s)
        heights, distances = (
            self._log.holding(target, attempt.started_s, until_s) if target >= 0 else (_NONE, _NONE)
        )
        # Where it lay: the attempt may have begun in a process that has ended.
        lay_m = self._log.centroids(attempt.started_s)[target, 2] if target >= 0 else 0.0
        is_lifted = bool(len(heights)) and float(heights.max() - lay_m) > _LIFTED_M
        return TrueGrasp(
            object=attempt.stone_id,
            lifted=is_lifted,
            dropped=is_lifted and _fell(heights, distances),
        )

    def _is_collision(self, span: Span, targets: Sequence[tuple[float, int]]) -> bool:
        """Return whether a contact was a collision.

        All contacts are, except those of gripper and jaws with the ground or with the targeted
        stone.
        """
        if span.link not in self._hand:
            return True
        if span.other == TERRAIN:
            return False
        if span.other not in self._log.stones:
            return True
        begun = [target for started_s, target in targets if started_s <= span.to_s]
        return not begun or self._log.stones[begun[-1]] != span.other


def _stance(legs: Legs | None) -> Nothing | Stance:
    """Return how near a machine on its legs came to tipping; nothing of one that is welded."""
    return Nothing() if legs is None else Stance(legs.most_tilt_rad, legs.least_margin_m)


def _fell(heights: Float, distances: Float) -> bool:
    """Return whether a lifted stone fell without the gripper, from higher than a release."""
    top = int(np.argmax(heights))
    since = distances[top:] - distances[top]
    away = np.flatnonzero(since > _RELEASED_M)
    if not len(away):
        return False
    # Index of the last sample at which the stone was still in the jaws.
    held = np.flatnonzero(since[: away[0] + 1] < _HELD_M)[-1]
    return bool(heights[top + held] - heights[top + held :].min() > _DROPPED_M)


def _as_report(span: Span) -> Collision:
    return Collision(
        bodies=(span.link, span.other),
        from_s=round(span.from_s, 2),
        to_s=round(span.to_s, 2),
        max_force_n=round(span.max_force_n, 1),
    )


def _estimate(states: Sequence[BaseState], log: TruthLog) -> Nothing | EstimateErrors:
    """Return the errors of the estimated cabin pose; nothing if there was no estimate."""
    ready = [state for state in states if state.is_ready and state.stamp_s <= log.end_s]
    if not ready:
        return Nothing()
    true = [log.T_world_cabin(state.stamp_s) for state in ready]
    offsets = np.array([s.T_map_cabin[:3, 3] - T[:3, 3] for s, T in zip(ready, true, strict=True)])
    turns = [
        angle_between(T[:3, :3], s.T_map_cabin[:3, :3]) for s, T in zip(ready, true, strict=True)
    ]
    bias, std = float(np.linalg.norm(offsets.mean(axis=0))), float(offsets.std(axis=0).mean())
    return EstimateErrors(
        PositionErrors(*_statistics(np.linalg.norm(offsets, axis=1)), bias, std),
        AngleErrors(*_statistics(np.array(turns))),
    )


def _statistics(values: Float) -> tuple[float, float, float]:
    """Return the mean, the standard deviation and the largest value."""
    return float(values.mean()), float(values.std()), float(values.max())
