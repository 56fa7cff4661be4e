"""The object database against the truth: which stones it knows, and each realigned pose."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from executive_plugins.robot.mujoco.truth.truth_log import TruthLog

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_between
from executive.messages.stone_event import StoneEvent

SAME_STONE_M = 0.7  # largest distance of an estimated centroid from the true one of its stone

Histories = Mapping[int, Sequence[StoneEvent]]  # by the object's number, oldest event first


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

    def objects(self) -> dict[str, int]:
        """Return counts: `stones` of the site, `known` ones, known `twice`, and `ghosts`.

        A ghost is an object of the database where no stone was.
        """
        found = [stone for stone in self._stones.values() if stone is not None]
        return {
            "stones": len(self._log.stones),
            "known": len(set(found)),
            "twice": len(found) - len(set(found)),
            "ghosts": len(self._stones) - len(found),
        }

    def realignments(self) -> list[dict[str, Any]]:
        """Return an entry for each release of each known stone.

        `settled_error_m` and `settled_error_rad` are those of the pose after the release, which
        follows from the gripper's motion (Mascaro 2020, Eq. 3); `error_m` and `error_rad` those
        after the first realignment, and equal to the former where there was none.
        """
        return [
            entry
            for number, stone in self._stones.items()
            if stone is not None
            for entry in self._of_object(stone, self._histories[number])
        ]

    def _of_object(self, stone: int, events: Sequence[StoneEvent]) -> Iterator[dict[str, Any]]:
        first = events[0]
        T_stone_object = inverse(self._log.T_world_stone(stone, first.stamp_s)) @ first.T_map_object
        releases = [i for i, event in enumerate(events) if event.kind == "release"]
        for number, i in enumerate(releases):
            last = releases[number + 1] if number + 1 < len(releases) else len(events)
            realigned = next((e for e in events[i:last] if e.kind == "realign"), None)
            settled_m, settled_rad = self._error(stone, T_stone_object, events[i])
            error_m, error_rad = self._error(stone, T_stone_object, realigned or events[i])
            yield {
                "stone": stone + 1,
                "round": number + 1,
                "was_realigned": realigned is not None,
                "settled_error_m": settled_m,
                "settled_error_rad": settled_rad,
                "error_m": error_m,
                "error_rad": error_rad,
            }

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
