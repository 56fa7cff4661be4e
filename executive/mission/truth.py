"""The report's `truth` section: the only place that compares a mission with the simulator."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from executive import registry
from executive.geometry.pose import transform
from executive.interfaces.oracle import MissionView, Oracle
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot
from executive.mission.mission import Mission
from executive.mission.picks import Pick, attempts_from, newest_releases


def truth_of(robot_name: str, mission: Mission, picks: Sequence[Pick]) -> dict[str, Any]:
    """Return {"truth": …} of a run on a robot that has an oracle, else nothing."""
    if robot_name not in registry.names(registry.ORACLES):
        return {}
    plugins = mission.services.plugins
    oracle: Oracle = registry.load(registry.ORACLES, robot_name)(plugins["robot"])
    objects = plugins.get("objects")
    stones = () if objects is None else objects.stones()
    at = mission.clock.machine_at  # the simulator knows nothing of pauses
    histories = None
    if objects is not None:
        histories = {
            one.id: [replace(e, stamp_s=at(e.stamp_s)) for e in objects.history(one.id)]
            for one in stones
        }
    view = MissionView(
        states=tuple(mission.guard.judged),
        stones=stones,
        first_stones=tuple(mission.first_stones.values()),
        slots=_slots(picks),
        attempts=[
            replace(one, started_s=at(one.started_s), ended_s=at(one.ended_s))
            for one in attempts_from(picks)
        ],
        histories=histories,
        map_cloud=plugins["mapping"].cloud() if "mapping" in plugins else None,
        registered_survey=_registered_survey(mission),
    )
    return {"truth": oracle.truth(view)}


def _slots(picks: Sequence[Pick]) -> dict[int, Slot]:
    """Return the slot of each stone according to the mission: its newest pick decides."""
    return {
        stone: Slot(released.slot, np.array(released.slot_position))
        for stone, released in newest_releases(picks).items()
    }


def _registered_survey(mission: Mission) -> Cloud | None:
    """Return the survey where its last accepted registration lays it, in the frame `map`."""
    found = mission.account.registered
    if found is None or mission.survey is None:
        return None
    points = transform(found.T_map_survey, found.scale * mission.survey.points)
    return Cloud("map", points)
