"""Reports of runs: picks from a journal, counts, timings and the summary for people."""

import dataclasses
from types import SimpleNamespace

import numpy as np

from executive.events.mission import VerdictGiven
from executive.events.site import BuildingEnded
from executive.events.stone import (
    AttemptStarted,
    GraspRecord,
    JawsClosedOnNothing,
    StoneRealigned,
    StoneReleased,
    StoneSetAside,
    StonesTakenUpAgain,
)
from executive.interfaces.report import (
    Counts,
    FigureReport,
    LateTicksReport,
    MissionReport,
    PausesReport,
)
from executive.interfaces.truth import (
    AngleErrors,
    Collision,
    EstimateErrors,
    PositionErrors,
    Stance,
    TrueStone,
    TrueStructure,
    Truth,
)
from executive.mission.picks import attempts_from, newest_releases
from executive.mission.record.account import Account
from executive.mission.record.samples import Samples
from executive.mission.report import Ending, summary, timings_from
from executive.testing.blank import blank


def made(kind, **given):
    """Return an event with the given fields, and something simple in the others."""
    fields = [one.name for one in dataclasses.fields(kind) if one.init]
    simple = {"stone": 1, "reason": "so", "accepted": True, "slot": 2, "passed_over": ()}
    poses = {name: np.eye(4) for name in fields if name.endswith("_pose")}
    values = dict.fromkeys(fields, 0.5) | {k: v for k, v in simple.items() if k in fields}
    return kind(**values | poses | given)


def grasp() -> GraspRecord:
    return made(GraspRecord, costs={"a": 1.0})


def journal() -> list[SimpleNamespace]:
    def attempt(stone: int):
        return made(AttemptStarted, stone=stone, centroid_map=np.arange(3.0), grasp=grasp())

    def released(stone: int):
        return made(StoneReleased, stone=stone, slot_position=np.zeros(3))

    events = [
        attempt(1),
        made(VerdictGiven, trouble="slip", detail="x"),
        attempt(1),
        released(1),
        made(StoneRealigned, stone=1, estimated_pose=2 * np.eye(4)),
        made(StoneRealigned, stone=9),
        attempt(2),
        made(JawsClosedOnNothing, stone=2),
        made(VerdictGiven, trouble="drop", detail="y"),
        made(StoneSetAside, stone=2),
        made(StonesTakenUpAgain, stones=(2,)),
        attempt(2),
        attempt(3),
        released(3),
        attempt(1),
        made(StoneSetAside, stone=1),
        made(StoneSetAside, stone=4),
    ]
    return [SimpleNamespace(time_s=2.5 * k, event=event) for k, event in enumerate(events)]


def test_picks(recorded) -> None:
    picks = Account.of(journal()).picks()
    told = [pick.as_report() for pick in picks], attempts_from(picks), newest_releases(picks)
    first = Account.of(journal()[:1]).picks()
    recorded((told, Account.of(journal()).counts(), Account.of([]).picks(), first))


def test_timings(recorded) -> None:
    values = {"b": [3.0, 1.0, 2.0, 9.0], "a": [1.23456], "none": []}
    samples = {stage: Samples() for stage in values}
    for stage, one in ((stage, one) for stage, several in values.items() for one in several):
        samples[stage].append(one)
    recorded(timings_from(samples))


def test_endings(recorded) -> None:
    recorded([Ending(one, "").exit_status for one in ("success", "failure", "stopped", "fault")])


def report(counts=None, **changed):
    whole = {"mission": "m", "seed": 3, "outcome": "success", "ended_s": 125.25, "wall_s": 59.96,
             "real_time_factor": 2.0891}  # fmt: skip
    return blank(MissionReport, counts=blank(Counts, **(counts or {})), **{**whole, **changed})


def test_summaries(recorded) -> None:
    errors = (0.1, 0.2, 0.25, 0.5, None)
    position = blank(PositionErrors, mean=0.0123, max=0.1)
    truth = blank(
        Truth,
        scenario="wet",
        stones=tuple(blank(TrueStone, slot_error_m=error) for error in errors),
        collisions=(blank(Collision), blank(Collision)),
        estimate=EstimateErrors(position, blank(AngleErrors)),
    )
    all_counts = {one.name: number for number, one in enumerate(dataclasses.fields(Counts), 1)}
    told = [
        report(),
        report(reason="why", counts={"picks": 3, "placed": 2, "attempts": 4, "first_attempt": 1}),
        report(counts={"registrations": 2, "registrations_accepted": 1, "plugin_failures": 1}),
        report(ignored_observations={"Strange": 7}, truth=truth),
        report(truth=blank(Truth)),
        report(truth=blank(Truth, scenario="nominal", stance=Stance(0.02, 0.4))),
        report(truth=dataclasses.replace(truth, collisions=None)),
        report(
            truth=blank(
                Truth,
                structures=(
                    TrueStructure("wall", (1, 4), (), (0.001, 0.25), {"fill": 0.4, "joints": None}),
                    TrueStructure("row", (), (), ()),
                    TrueStructure("ring", (3,), (), ()),
                ),
            )
        ),
        report(
            counts=all_counts,
            structures=(
                BuildingEnded("wall", "complete", "all of it", (1, 2), {}),
                BuildingEnded(
                    "row", "nothing_fits", "none", (), {}, {"4": {"tilts": 5, "topples": 2}}
                ),
            ),
            figures={"depth": FigureReport(1.5, "m"), "n": FigureReport(2.0, "")},
            pauses=PausesReport(2, 3.0, 65.5),
            late_ticks=LateTicksReport(
                4,
                0.25,
                5,
                "leaf in main/3:PlanPick",
                {"mapping.add_scan_pair": 3, "leaf in main/3:PlanPick": 1},
            ),
        ),
        report(pauses=PausesReport(0, 0.0, 0.0), late_ticks=LateTicksReport(0, 0.0, 5)),
        report(late_ticks=LateTicksReport(2, 0.25, 5)),
    ]
    recorded([summary(one) for one in told])
