"""Each shipped metric on runs that are made up, with the value that its definition gives."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from executive import registry
from executive.campaign.figures.metrics.figure import Figure
from executive.events.event import Event
from executive.events.fault import FaultInjected, FaultShows
from executive.events.node import NodeStarted
from executive.events.site import SiteScanned, SiteSegmented, SiteSurveyed, SurveyRegistered
from executive.events.stone import (
    AttemptStarted,
    GraspRecord,
    GraspsPlanned,
    StoneGrasped,
    StoneRealigned,
    StoneReleased,
)
from executive.events.watch import ConditionBroken, SamplesMissing
from executive.interfaces.metric import RunRecord, Share, TimedEvent, Values
from executive.interfaces.report import (
    AttemptReport,
    Counts,
    FigureReport,
    MissionReport,
    PickReport,
    Resources,
)
from executive.interfaces.truth import (
    AngleErrors,
    Collision,
    Distances,
    EstimateErrors,
    KnownObjects,
    MapErrors,
    PositionErrors,
    Realignment,
    RegistrationErrors,
    TrueGrasp,
    TrueStone,
    Truth,
)
from executive.testing.blank import blank

METRICS = "metric"


def attempt(started_s: float, ended_s: float, outcome: str) -> AttemptReport:
    return blank(AttemptReport, started_s=started_s, ended_s=ended_s, outcome=outcome)


def pick(number: int, *attempts: AttemptReport, placed: bool) -> PickReport:
    return blank(PickReport, object=number, attempts=attempts, placed=placed)


def of_stone(
    number: int, held: int | None, slot_m: float | None, base_m: float | None
) -> TrueStone:
    error_rad = None if base_m is None else base_m / 2
    return blank(
        TrueStone,
        id=number,
        held_object=held,
        slot_error_m=slot_m,
        database_error_m=base_m,
        database_error_rad=error_rad,
    )


def grasp(*, lifted: bool, dropped: bool) -> TrueGrasp:
    return TrueGrasp(1, lifted, dropped)


def release(error_m: float, *, realigned: bool) -> Realignment:
    return Realignment(
        stone=1,
        round=1,
        was_realigned=realigned,
        error_m=error_m,
        error_rad=error_m / 2,
        settled_error_m=3 * error_m,
        settled_error_rad=4 * error_m,
    )


COUNTS = blank(Counts, slips=2, plugin_failures=3, registrations=4, registrations_accepted=1)
POSITIONS = PositionErrors(mean=0.02, std=0.0, max=0.07, bias=0.0, component_std=0.0)
HIT = blank(Collision)
# The relocation of object 1 took two attempts, that of object 2 one; object 1 was moved once more.
REPORT = blank(
    MissionReport,
    outcome="success",
    started_s=2.0,
    ended_s=50.0,
    wall_s=12.5,
    real_time_factor=4.0,
    resources=Resources(25.0, 10**9, compiling_s=5.0),
    figures={"stones_found": FigureReport(3.0, "")},
    counts=COUNTS,
    picks=(
        pick(1, attempt(10.0, 12.0, "drop"), attempt(13.0, 20.0, "placed"), placed=True),
        pick(2, attempt(5.0, 8.0, "slip"), placed=True),
        pick(1, attempt(30.0, 33.0, "drop"), placed=False),
    ),
    truth=blank(
        Truth,
        stones=(
            of_stone(1, 1, 0.1, 0.2),
            of_stone(2, 2, 0.30, None),
            of_stone(3, None, None, 0.4),
            of_stone(4, 9, 0.31, 0.1),
        ),
        # By time: slip, drop, placed, drop.
        grasps=(
            grasp(lifted=True, dropped=True),
            grasp(lifted=True, dropped=False),
            grasp(lifted=True, dropped=True),
            grasp(lifted=False, dropped=False),
        ),
        collisions=(HIT, HIT),
        estimate=EstimateErrors(POSITIONS, AngleErrors(0.0, 0.0, 0.0)),
        map=MapErrors(Distances(0.03, 0.0), 0.002, 0.01),
        registration=RegistrationErrors(0.6, 0.0),
        realignments=(release(0.1, realigned=True), release(0.2, realigned=False)),
        objects=KnownObjects(stones=4, known=3, twice=2, ghosts=1),
    ),
)
BARE = replace(
    REPORT,
    outcome="failure",
    ended_s=0.0,
    resources=Resources(0.0, 2000),
    counts=blank(Counts),
    picks=(),
    truth=None,
)


def with_truth(**values: Any) -> MissionReport:
    """Return the report of a run of which the simulator knows the given values alone."""
    return replace(REPORT, truth=blank(Truth, **values))


def at(time_s: float, event: Event, node: str = "") -> TimedEvent:
    return TimedEvent(time_s, event, node)


def registered(time_s: float, *, accepted: bool) -> TimedEvent:
    return at(time_s, made(SurveyRegistered, accepted=accepted))


def made(kind: type[Event], **values: Any) -> Event:
    """Return an event with zeros where nothing is given."""
    return kind(**{**{one.name: 0.0 for one in fields(kind)}, **values})


GRASP = GraspRecord(np.eye(4), 1.0, 0.5, {})


def started(stone: int) -> Event:
    return AttemptStarted(stone, np.zeros(3), GRASP, ())


EVENTS = (
    at(3.0, made(SiteSurveyed)),
    at(4.0, made(NodeStarted), "main/0:scan"),
    at(4.5, made(SiteSurveyed)),
    at(9.0, made(SiteScanned), "main/0:scan"),
    at(9.5, made(SiteScanned), "main/1:other"),
    registered(10.0, accepted=False),
    registered(11.0, accepted=True),
    registered(12.0, accepted=True),
    at(12.5, made(SiteSegmented)),
    at(14.0, made(SiteSegmented)),
    at(15.0, made(NodeStarted), "main/2:plan"),
    at(16.0, made(GraspsPlanned, stone=1), "main/2:plan"),
    at(17.0, made(NodeStarted), "main/3:choose"),
    at(18.0, started(1), "main/3:choose"),
    at(21.0, made(StoneGrasped, stone=2)),  # not the stone of the attempt
    at(22.0, made(NodeStarted), "main/3:choose"),
    at(22.5, started(1), "main/3:choose"),
    at(26.0, made(StoneGrasped, stone=1)),
    at(33.0, made(StoneReleased, stone=1)),
    at(35.0, made(StoneRealigned, stone=1)),
    at(36.0, made(StoneRealigned, stone=1)),
    at(37.0, made(StoneReleased, stone=2)),
    at(40.0, FaultInjected(1, "imu_cabin", "silent")),
    at(41.5, ConditionBroken("imu_cabin", "old")),
    at(42.0, FaultInjected(2, "boom", "weak", is_hidden=True)),
    at(43.0, FaultShows(1, 0.1)),
    at(44.0, FaultShows(2, 0.1)),
    at(46.0, ConditionBroken("tracking", "far")),
    at(47.0, FaultInjected(3, "boom", "weak", is_hidden=True)),
    at(47.5, ConditionBroken("tracking", "far")),
)
BLIND = (*EVENTS, at(48.0, FaultInjected(4, "gnss", "silent")))
EXPECTED = {
    "success": Share(1, 1),
    "placed": Share(2, 4),  # 0.30 m counts
    "first_attempt": Share(1, 4),
    "within_three": Share(2, 4),
    "attempts": Values((2, 1, 1)),
    "placement_error": Values((0.1, 0.30, 0.31)),
    "lifted": Share(3, 4),
    "held": Share(1, 3),
    "drops_found": Share(1, 2),
    "drops_missed": Values((1,)),
    "false_alarms": Share(2, 2),
    "slips": Values((2,)),
    "collisions": Values((2,)),
    "mission_time": Values((48.0,)),
    "cycle_time": Values((10.0, 3.0)),
    "mapping_time": Values((12.5,)),
    "scan_time": Values((5.0,)),
    "plan_time": Values((3.0, 0.5)),
    "reach_time": Values((3.5,)),
    "carry_time": Values((7.0,)),
    "realign_time": Values((2.0,)),
    "registrations": Share(1, 4),
    "registered": Share(1, 1),
    "registration_error": Values((0.6,)),
    "registration_time": Values((8.0,)),
    "estimator_error": Values((0.02,)),
    "estimator_error_max": Values((0.07,)),
    "map_error": Values((0.03,)),
    "map_bias": Values((0.002,)),
    "map_std": Values((0.01,)),
    "database_error_m": Values((0.2, 0.4, 0.1)),
    "database_error_rad": Values((0.1, 0.2, 0.05)),
    "settled_error_m": Values((0.3, 0.6)),
    "settled_error_rad": Values((0.4, 0.8)),
    "realigned": Share(1, 2),
    "realignment_error_m": Values((0.1,)),
    "realignment_error_rad": Values((0.05,)),
    "stones_known": Share(3, 4),
    "ghosts": Values((3,)),
    "cpu_per_simulated_second": Values((0.4,)),
    "peak_memory": Values((1e9,)),
    "wall_time": Values((12.5,)),
    "real_time_factor": Values((4.0,)),
    "plugin_failures": Values((3,)),
    "faults_noticed": Share(3, 3),
    "notice_time": Values((1.5, 2.0, 0.0)),
    "faulty_success": Share(1, 1),  # a stone is 0.4 m off its pose in the database
    "unsafe": Share(1, 1),
}
# Of a run without truth, stones, registrations and events.
NOTHING = {
    "success": Share(0, 1),
    "peak_memory": Values((2000,)),
    "slips": Values((0,)),
    "mission_time": Values((-2.0,)),
    "wall_time": Values((12.5,)),
    "real_time_factor": Values((4.0,)),
    "plugin_failures": Values((0,)),
    "faulty_success": Share(0, 1),
    **dict.fromkeys(("cycle_time", "mapping_time", "scan_time", "plan_time"), Values(())),
    **dict.fromkeys(("reach_time", "carry_time", "realign_time"), Values(())),
}
OF_EXAMPLES = {"as_named", "false_success"}  # see test_example_metrics.py
OF_STRUCTURES = {  # see test_structure_metrics.py
    "stones_built", "built_as_planned", "built_error_m", "built_error_rad", "standing_error_m",
    "structure_ended", "building_time", "building_time_p95",
    "stones_standing", "standing_moved_m", "standing_fill", "standing_joints", "standing_drift_m",
    "standing_pushed_m", "standing_tilt_across_rad", "standing_tilt_along_rad",
    "standing_tilt_slippery_rad",
}  # fmt: skip


def measured(name: str, report: Any, events: tuple[TimedEvent, ...]) -> Any:
    return registry.load(METRICS, name)().measure(RunRecord(report, events))


def test_each_shipped_metric_has_its_value_here() -> None:
    assert EXPECTED.keys() | OF_EXAMPLES | OF_STRUCTURES == set(registry.names(METRICS))


@pytest.mark.parametrize("name", EXPECTED)
def test_a_metric_is_what_its_definition_says(name: str) -> None:
    found, wanted = measured(name, REPORT, EVENTS), EXPECTED[name]
    if isinstance(wanted, Values):
        assert found.values == pytest.approx(wanted.values)
    else:
        assert found == wanted


# Of more of these is more better; of the others less.
GOOD = {
    "as_named", "built_as_planned", "drops_found", "faults_noticed", "first_attempt", "held",
    "lifted", "placed", "real_time_factor", "realigned", "registered", "registrations",
    "standing_fill", "standing_tilt_across_rad", "standing_tilt_along_rad",
    "standing_tilt_slippery_rad", "stones_built", "stones_known", "stones_standing",
    "structure_ended", "success", "within_three",
}  # fmt: skip
COUNTED = {"attempts", "collisions", "drops_missed", "ghosts", "plugin_failures", "slips",
          "standing_fill", "standing_joints", "stones_built", "stones_standing",
          "cpu_per_simulated_second", "real_time_factor"}  # fmt: skip


@pytest.mark.parametrize("name", registry.names(METRICS))
def test_a_metric_says_which_way_is_better_and_in_which_unit(name: str) -> None:
    found = registry.load(METRICS, name)()
    assert found.is_more_better is (name in GOOD)
    ends = {"_m": "m", "_rad": "rad", "_time": "s", "_p95": "s", "_memory": "byte"}
    unit = next((unit for end, unit in ends.items() if name.endswith(end)), "m")
    assert found.unit == ("" if found.is_share or name in COUNTED else unit)
    assert found.title


@pytest.mark.parametrize("name", EXPECTED)
def test_a_metric_that_is_a_share_measures_shares(name: str) -> None:
    assert registry.load(METRICS, name)().is_share is isinstance(EXPECTED[name], Share)


@pytest.mark.parametrize("name", EXPECTED)
def test_a_run_that_holds_nothing_to_measure_has_no_value(name: str) -> None:
    assert measured(name, BARE, ()) == NOTHING.get(name)


def test_a_fault_that_nothing_notices_counts_as_missed() -> None:
    assert measured("faults_noticed", REPORT, BLIND) == Share(3, 4)
    assert measured("notice_time", REPORT, BLIND).values == (1.5, 2.0, 0.0)
    told = (*BLIND, at(48.25, SamplesMissing("gnss", 1)))
    assert measured("faults_noticed", REPORT, told) == Share(4, 4)
    assert measured("notice_time", REPORT, told).values == (1.5, 2.0, 0.0, 0.25)
    true = with_truth(stones=(of_stone(1, 1, 0.30, 0.30),))
    assert measured("faulty_success", true, EVENTS) == Share(0, 1)
    assert measured("faulty_success", true, BLIND) == Share(1, 1)
    assert measured("faulty_success", replace(true, outcome="failure"), BLIND) == Share(0, 1)
    off = with_truth(stones=(of_stone(1, 1, 0.31, 0.0),))
    assert measured("faulty_success", off, EVENTS) == Share(1, 1)


@pytest.mark.parametrize(
    ("truth", "hits"),
    [
        ({"collisions": (), "grasps": (grasp(lifted=True, dropped=False),)}, 0),
        ({"collisions": (HIT,), "grasps": ()}, 1),
        ({"collisions": (), "grasps": (grasp(lifted=True, dropped=True),)}, 1),
        ({"collisions": ()}, 0),
    ],
)
def test_a_collision_or_a_fall_is_unsafe(truth: dict[str, Any], hits: int) -> None:
    assert measured("unsafe", with_truth(**truth), ()) == Share(hits, 1)


def test_no_attempt_is_lifted_or_held_where_none_was_made() -> None:
    none = replace(with_truth(grasps=()), picks=())
    assert measured("lifted", none, ()) is None
    assert measured("held", none, ()) is None
    assert measured("drops_found", none, ()) == Share(0, 0)
    assert measured("drops_missed", none, ()) == Values((0,))
    assert measured("false_alarms", none, ()) == Share(0, 0)
    on_ground = with_truth(grasps=(grasp(lifted=False, dropped=False),))
    one = replace(on_ground, picks=REPORT.picks[1:2])
    assert measured("lifted", one, ()) == Share(0, 1)
    assert measured("held", one, ()) is None


@pytest.mark.parametrize(
    ("outcome", "missed"),
    [
        ("drop", 0),
        ("slip", 0),
        ("empty", 0),
        ("not lifted", 0),
        ("shifted", 0),
        ("placed", 1),
        ("unfinished", 1),
    ],
)
def test_a_fall_is_missed_unless_its_attempt_ended_for_it(outcome: str, missed: int) -> None:
    """A stone that falls in its trial lift is told as one that does not hang."""
    fallen = with_truth(grasps=(grasp(lifted=True, dropped=True),))
    one = replace(fallen, picks=(pick(1, attempt(10.0, 12.0, outcome), placed=False),))
    assert measured("drops_missed", one, ()) == Values((missed,))
    assert measured("drops_found", one, ()) == Share(1 - missed, 1)


def test_a_survey_that_is_never_registered_has_no_time() -> None:
    assert measured("registration_time", REPORT, EVENTS[:6]) == Values(())
    refused = replace(REPORT, counts=replace(COUNTS, registrations_accepted=0))
    assert measured("registered", refused, ()) == Share(0, 1)
    assert measured("registrations", refused, ()) == Share(0, 4)


def test_a_figure_of_a_mission_is_a_metric() -> None:
    assert Figure("stones_found").measure(RunRecord(REPORT)) == Values((3.0,))
    assert Figure("others").measure(RunRecord(REPORT)) is None


def test_what_an_oracle_does_not_observe_is_not_measured() -> None:
    unknown = with_truth()
    names = ("lifted", "held", "drops_found", "drops_missed", "false_alarms", "collisions")
    more = (
        "estimator_error",
        "map_error",
        "map_bias",
        "map_std",
        "registration_error",
        "stones_known",
        "ghosts",
    )
    releases = ("realigned", "realignment_error_m", "settled_error_rad")
    assert {measured(name, unknown, ()) for name in (*names, *more, *releases)} == {None}
