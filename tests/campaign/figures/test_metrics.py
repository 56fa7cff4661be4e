"""The metrics, on runs whose reports and journals are made up."""

from typing import Any

import numpy as np
import pytest

from executive import registry
from executive.campaign.figures.measurement import measure, metric
from executive.events.event import Event
from executive.events.fault import FaultInjected
from executive.events.node import NodeEnded, NodeResult, NodeStarted
from executive.events.site import SiteScanned, SiteSegmented, SiteSurveyed, SurveyRegistered
from executive.events.stone import (
    AttemptStarted,
    GraspRecord,
    GraspsPlanned,
    StoneGrasped,
    StoneRealigned,
    StoneReleased,
)
from executive.events.watch import ConditionBroken
from executive.interfaces.metric import Metric, RunRecord, Share, TimedEvent, Values

NAMES = [one.name for one in registry.installed(registry.METRICS)]
GRASP = GraspRecord(np.eye(4), 1.0, 0.5, {})


def attempt(started_s: float, ended_s: float, outcome: str = "placed") -> dict[str, Any]:
    return {
        "grasp": {},
        "outcome": outcome,
        "reason": "",
        "started_s": started_s,
        "ended_s": ended_s,
    }


def pick(number: int, *attempts: dict[str, Any], placed: bool = True) -> dict[str, Any]:
    return {"object": number, "attempts": list(attempts), "placed": placed}


def stone(number: int, held: int | None, slot_error_m: float | None) -> dict[str, Any]:
    return {
        "id": number,
        "held_object": held,
        "slot_error_m": slot_error_m,
        "database_error_m": None if held is None else 0.01 * number,
        "database_error_rad": None if held is None else 0.001 * number,
    }


def report(**changed: Any) -> dict[str, Any]:
    """Return the report of a mission on four stones, of which the fourth is never found."""
    made = {
        "outcome": "success",
        "started_s": 0.0,
        "ended_s": 200.0,
        "wall_s": 100.0,
        "real_time_factor": 2.0,
        "resources": {"cpu_s": 150.0, "peak_memory_bytes": 2_000_000},
        "counts": {
            "slips": 1,
            "plugin_failures": 3,
            "registrations": 4,
            "registrations_accepted": 1,
        },
        "picks": [
            pick(11, attempt(10.0, 35.0)),
            pick(12, attempt(40.0, 60.0, "drop"), attempt(70.0, 95.0)),
            pick(13, attempt(100.0, 120.0, "slip"), attempt(130.0, 160.0)),
        ],
        "truth": {
            "stones": [
                stone(1, 11, 0.10),
                stone(2, 12, 0.30),
                stone(3, 13, 0.31),
                stone(4, None, None),
            ],
            "grasps": [
                {"object": 11, "lifted": True, "dropped": False},
                {"object": 12, "lifted": True, "dropped": True},
                {"object": 12, "lifted": True, "dropped": False},
                {"object": 13, "lifted": True, "dropped": True},
                {"object": 13, "lifted": False, "dropped": False},
            ],
            "collisions": [{}, {}],
            "estimate": {"error_m": {"mean": 0.02, "max": 0.05}},
            "objects": {"stones": 4, "known": 3, "twice": 1, "ghosts": 2},
            "realignments": [realignment(0.1, 0.02, was_realigned=True), realignment(0.3, 0.3)],
            "registration": {"error_m": 0.03, "error_rad": 0.001},
            "map": {"distance_m": {"median": 0.004, "p95": 0.02}},
        },
    }
    return made | changed


def realignment(settled: float, after: float, was_realigned: bool = False) -> dict[str, Any]:
    return {
        "was_realigned": was_realigned,
        "settled_error_m": settled,
        "settled_error_rad": settled / 10,
        "error_m": after,
        "error_rad": after / 10,
    }


def events() -> list[TimedEvent]:
    """Return the journal of a scan, a registration and one relocation."""
    none = np.zeros(3)
    told: list[tuple[float, Event, str]] = [
        (2.0, SiteSurveyed(100), "survey"),
        (3.0, NodeStarted(), "scan"),
        (5.0, registered(False), "register"),
        (7.0, registered(True), "register"),
        (9.0, registered(True), "register"),
        (23.0, SiteScanned(5), "scan"),
        (23.0, NodeEnded(NodeResult.SUCCESS, ""), "scan"),
        (25.0, SiteSegmented((1,), (9,)), "segment"),
        (26.0, NodeStarted(), "plan"),
        (27.0, GraspsPlanned(1, 5, {}), "plan"),
        (27.0, NodeStarted(), "pick"),
        (29.0, AttemptStarted(1, none, GRASP, ()), "pick"),
        (33.0, NodeStarted(), "pick"),  # the jaws closed on nothing: the next grasp
        (34.5, AttemptStarted(1, none, GRASP, ()), "pick"),
        (44.5, StoneGrasped(1, 0.3, 0, 0), "close"),
        (60.5, StoneReleased(1, 1, none, np.eye(4), np.eye(4)), "release"),
        (70.0, NodeStarted(), "scan"),
        (76.0, SiteScanned(5), "scan"),
        (77.0, StoneRealigned(1, True, "alignment", "", 0.01, 0.9, np.eye(4)), "realign"),
    ]
    return [TimedEvent(time_s, event, node) for time_s, event, node in told]


def registered(accepted: bool) -> SurveyRegistered:
    return SurveyRegistered(accepted, "", 0.0, 0.0, 1.0, 3, np.eye(4))


def measured(made: dict[str, Any] | None = None) -> dict[str, Any]:
    return measure(RunRecord(report() if made is None else made, events()), NAMES)


@pytest.mark.parametrize(
    ("name", "hits", "of"),
    [
        ("success", 1, 1),
        ("placed", 2, 4),  # the third stands a centimetre too far off; the fourth was not found
        ("first_attempt", 1, 4),  # the second took two attempts
        ("lifted", 4, 5),
        ("held", 2, 4),
        ("drops_found", 2, 2),  # by the outcomes `drop` and `slip`
        ("false_alarms", 0, 3),
        ("registrations", 1, 4),
        ("registered", 1, 1),
        ("stones_known", 3, 4),
        ("realigned", 1, 2),
    ],
)
def test_shares(name: str, hits: int, of: int) -> None:
    assert measured()[name] == {"hits": hits, "of": of}


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("placement_error", [0.10, 0.30, 0.31]),
        ("attempts", [1, 2, 2]),
        ("cycle_time", [25.0, 55.0, 60.0]),
        ("mission_time", [200.0]),
        ("mapping_time", [25.0]),
        ("scan_time", [20.0, 6.0]),
        ("plan_time", [3.0, 1.5]),
        ("reach_time", [10.0]),
        ("carry_time", [16.0]),
        ("realign_time", [16.5]),
        ("registration_time", [5.0]),
        ("registration_error", [0.03]),
        ("drops_missed", [0]),
        ("slips", [1]),
        ("collisions", [2]),
        ("plugin_failures", [3]),
        ("database_error_m", [0.01, 0.02, 0.03]),
        ("database_error_rad", [0.001, 0.002, 0.003]),
        ("settled_error_m", [0.1, 0.3]),
        ("settled_error_rad", [0.01, 0.03]),
        ("realignment_error_m", [0.02]),
        ("realignment_error_rad", [0.002]),
        ("ghosts", [3]),
        ("estimator_error", [0.02]),
        ("estimator_error_max", [0.05]),
        ("map_error", [0.004]),
        ("cpu_per_simulated_second", [0.75]),
        ("peak_memory", [2_000_000]),
        ("wall_time", [100.0]),
        ("real_time_factor", [2.0]),
    ],
)
def test_values(name: str, values: list[float]) -> None:
    assert measured()[name]["values"] == pytest.approx(values)


def test_drops_that_the_mission_did_not_notice_and_alarms_without_a_drop() -> None:
    made = report()
    made["picks"] = [
        pick(1, attempt(0, 1, "placed"), attempt(2, 3, "drop"), attempt(4, 5, "failed"))
    ]
    made["truth"]["grasps"] = [
        {"object": 1, "lifted": True, "dropped": True},
        {"object": 1, "lifted": True, "dropped": False},
        {"object": 1, "lifted": False, "dropped": False},
    ]
    found = measured(made)
    assert found["drops_found"] == {"hits": 0, "of": 1}
    assert found["drops_missed"] == {"values": [1]}
    assert found["false_alarms"] == {"hits": 1, "of": 2}


def test_a_run_without_truth_has_no_metric_of_the_truth() -> None:
    made = report()
    del made["truth"]
    found = measured(made)
    assert not [one for one in found.values() if "problem" in one]
    by_truth = {"placed", "first_attempt", "lifted", "drops_found", "map_error", "ghosts"}
    assert not by_truth & set(found)
    assert {"success", "cycle_time", "registrations"} <= set(found)


@pytest.mark.parametrize("outcome", ["failure", "stopped", "fault"])
def test_only_success_is_success(outcome: str) -> None:
    assert measured(report(outcome=outcome))["success"] == {"hits": 0, "of": 1}


def test_a_mission_that_picks_nothing_is_measured_without_error() -> None:
    made = report(picks=[], ended_s=0.0, counts=dict.fromkeys(report()["counts"], 0))
    made["truth"] |= {
        "stones": [],
        "grasps": [],
        "estimate": {},
        "objects": {},
        "map": {},
        "registration": {},
    }
    found = measure(RunRecord(made, ()), NAMES)
    assert not [one for one in found.values() if "problem" in one]
    assert found["cycle_time"] == {"values": []}
    assert "registrations" not in found


def measure_of(name: str, one: Metric) -> Share | Values | None:
    """Measure the run above; for some metrics as an example, or with a fault that was noticed."""
    made, told = report(), events()
    if name in ("as_named", "false_success"):
        made["mission"] = "clear_corridor"
    if name in ("faults_noticed", "notice_time"):
        told += [
            TimedEvent(180.0, FaultInjected(1, "imu_cabin", "silent"), ""),
            TimedEvent(180.1, ConditionBroken("imu_cabin", "silent for 0.1 s"), ""),
        ]
    return one.measure(RunRecord(made, told))


@pytest.mark.parametrize("name", NAMES)
def test_each_metric_says_what_it_is(name: str) -> None:
    one = metric(name)
    assert one.title
    assert one.description.endswith(".")
    assert measure_of(name, one) is not None
    assert not (one.is_share and one.unit)
