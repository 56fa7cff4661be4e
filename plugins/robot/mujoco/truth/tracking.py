"""The object database against the truth: which stones it knows, and each realigned pose."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from executive_plugins.robot.mujoco.truth.truth_log import TruthLog

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_between
from executive.interfaces.truth import KnownObjects, Realignment
from executive.messages.stone_event import StoneEvent

SAME_STONE_M = 0.7  # largest distance of an estimated centroid from the true one of its stone

Histories = Mapping[int, Sequence[StoneEvent]]  # by the object's number, oldest event first


@dataclass(frozen=True, slots=True)
class PoseError:
    """How far the pose of an object is off [m], [rad], and how many models the object has had."""

    away_m: float
    away_rad: float
    models: int


class Tracking:
    """Objects of the database, each with the simulated stone that it was found as.

    Args:
        log: True poses.
        histories: What happened to each object.
    """

    def __init__(self, log: TruthLog, histories: Histories) -> None:
        self._log = log
        self._histories = {number: events for number, events in histories.items() if events}
        self._stones = {
            number: _nearest(log, events[0]) for number, events in self._histories.items()
        }

    def objects(self) -> KnownObjects:
        """Return how the database knows the site."""
        found = [stone for stone in self._stones.values() if stone is not None]
        return KnownObjects(
            stones=len(self._log.stones),
            known=len(set(found)),
            twice=len(found) - len(set(found)),
            ghosts=len(self._stones) - len(found),
        )

    def found_as(self, stone: int) -> int | None:
        """Return the number of the first object that a stone was found as; None if of none."""
        return next((number for number, found in self._stones.items() if found == stone), None)

    def error(self, number: int, T_map_object: Float) -> PoseError | None:
        """Return how far a pose of an object is off at the end, since its newest model was seen.

        None of an object that is no stone.
        """
        stone = self._stones[number]
        if stone is None:
            return None
        events = self._histories[number]
        bases = self._bases(stone, events)
        base = events[bases[-1]]
        at_end = replace(base, stamp_s=self._log.end_s, T_map_object=T_map_object)
        away_m, away_rad = self._error(stone, self._T_stone_object(stone, base), at_end)
        return PoseError(away_m, away_rad, len(bases))

    def realignments(self) -> tuple[Realignment, ...]:
        """Return an entry for each release of each known stone.

        `settled_error_m` and `settled_error_rad` are those of the pose after the release, which
        follows from the gripper's motion (Mascaro 2020, Eq. 3); `error_m` and `error_rad` those
        after the first realignment, and equal to the former where there was none.
        """
        return tuple(
            entry
            for number, stone in self._stones.items()
            if stone is not None
            for entry in self._of_object(stone, self._histories[number])
        )

    def _of_object(self, stone: int, events: Sequence[StoneEvent]) -> Iterator[Realignment]:
        bases = self._bases(stone, events)
        releases = [i for i, event in enumerate(events) if event.kind == "release"]
        for number, i in enumerate(releases):
            base = max(n for n in bases if n <= i)
            T_stone_object = self._T_stone_object(stone, events[base])
            # Later it is corrected in the jaws, or it is another model's pose.
            later = range(i + 1, len(events))
            ends = (n for n in later if n in bases or events[n].kind in ("grasp", "release"))
            last = next(ends, len(events))
            realigned = next((e for e in events[i:last] if e.kind == "realign"), None)
            settled_m, settled_rad = self._error(stone, T_stone_object, events[i])
            error_m, error_rad = self._error(stone, T_stone_object, realigned or events[i])
            yield Realignment(
                stone=stone + 1,
                round=number + 1,
                was_realigned=realigned is not None,
                settled_error_m=settled_m,
                settled_error_rad=settled_rad,
                error_m=error_m,
                error_rad=error_rad,
            )

    def _bases(self, stone: int, events: Sequence[StoneEvent]) -> list[int]:
        """Return at which events an object got a model: when it was found, and when it was replaced
        by what was seen of the same stone. The frame of a new model has a rotation of its own.
        """
        return [
            i
            for i, event in enumerate(events)
            if i == 0 or (event.kind == "replaced" and _nearest(self._log, event) == stone)
        ]

    def _T_stone_object(self, stone: int, base: StoneEvent) -> Float:
        """Return the pose of an object in its stone, which a model keeps, shape (4, 4)."""
        return inverse(self._log.T_world_stone(stone, base.stamp_s)) @ base.T_map_object

    def _error(self, stone: int, T_stone_object: Float, event: StoneEvent) -> tuple[float, float]:
        """Return distance [m] and angle [rad] of a pose from where the stone has carried it."""
        T_expected = self._log.T_world_stone(stone, event.stamp_s) @ T_stone_object
        away = T_expected[:3, 3] - event.T_map_object[:3, 3]
        return (
            float(np.linalg.norm(away)),
            angle_between(T_expected[:3, :3], event.T_map_object[:3, :3]),
        )


def _nearest(log: TruthLog, first: StoneEvent) -> int | None:
    """Return the index of the stone that an object was found as; None if no stone was there."""
    distances = np.linalg.norm(log.centroids(first.stamp_s) - first.T_map_object[:3, 3], axis=1)
    if not len(distances) or distances.min() >= SAME_STONE_M:
        return None
    return int(np.argmin(distances))
