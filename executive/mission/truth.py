"""The report's `truth` section: the only place that compares a mission with the simulator."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from executive import registry
from executive.geometry.pose import transform
from executive.interfaces.oracle import MissionView, Oracle, Witness
from executive.interfaces.robot import Robot
from executive.interfaces.truth import Truth
from executive.messages.building import AsBuilt
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot
from executive.messages.structure import Structure
from executive.mission.assembly import Selections, assemble, needed_for
from executive.mission.judging import verdict_of
from executive.mission.mission import Mission
from executive.mission.picks import Pick, attempts_from, newest_releases


def truth_of(
    robot: Robot,
    name: str,
    mission: Mission,
    picks: Sequence[Pick],
    structures: Sequence[Structure] = (),
    judge: str = registry.NO_JUDGE,
) -> Truth:
    """Return what the oracle of a robot says of a run.

    Args:
        robot: A robot that has an oracle, and knows what happened.
        name: Its name, as installed.
        mission: The mission.
        picks: Its picks.
        structures: What was to be built.
        judge: Who judges what was built of them, by the poses at the end.
    """
    plugins = mission.services.plugins
    oracle: Oracle = registry.load(registry.ORACLES, name)(robot)
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
        slots=_slots(picks),
        attempts=[
            replace(one, started_s=at(one.started_s), ended_s=at(one.ended_s))
            for one in attempts_from(picks)
        ],
        histories=histories,
        map_cloud=plugins["mapping"].cloud() if "mapping" in plugins else None,
        registered_survey=_registered_survey(mission),
        structures=structures,
    )
    truth = oracle.truth(view)
    return _judged(truth, oracle, structures, judge) if structures else truth


def _judged(truth: Truth, oracle: Oracle, structures: Sequence[Structure], judge: str) -> Truth:
    """Return the truth with a judge's verdict on each structure in which a stone stands."""
    of_name = {one.name: one for one in structures}
    judged = []
    for one in truth.structures:
        built = None if judge == registry.NO_JUDGE else oracle.as_built(of_name[one.name])
        if built is not None and built.standing:
            judged.append(replace(one, verdict=_verdict(built, judge)))
        else:
            judged.append(one)
    return replace(truth, structures=tuple(judged))


def _verdict(built: AsBuilt, judge: str) -> Mapping[str, float | None]:
    """Return a judge's verdict; empty if it fails, which changes nothing of the run."""
    try:
        return verdict_of(built, judge)
    except Exception:  # whatever escapes a judge, which anybody may bring
        logging.getLogger(__name__).exception(
            "the judge '%s' gave no verdict on '%s'", judge, built.structure.name
        )
        return {}


@contextmanager
def witness_of(
    selections: Selections, model: str, seed: int, path: Path, zero_s: float
) -> Iterator[Robot]:
    """Give an equal copy of the robot of another process, which knows what happened there.

    Args:
        selections: What the mission selects, its simulated robot included.
        model: Name or folder of the machine.
        seed: Seed of the mission.
        path: What that robot has written.
        zero_s: What its clock showed when the mission began [s].

    Raises:
        DataError: If that is missing, or of another site.
    """
    assembly = assemble(needed_for(selections, "robot"), model, seed)
    assembly.start()
    try:
        robot = assembly.plugins["robot"]
        if isinstance(robot, Witness):
            robot.read_truth(path, zero_s)
        yield robot
    finally:
        assembly.close()


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
