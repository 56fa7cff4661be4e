"""Whether the examples did what their names say, on runs that are made up."""

from collections.abc import Sequence

import numpy as np
import pytest

from executive.campaign.figures.metrics.examples import AsNamed, FalseSuccess
from executive.events.finding import ListedStone, MapSaved
from executive.events.node import QuestionAnswered
from executive.events.site import RegionNamed
from executive.events.stone import (
    AttemptStarted,
    GraspRecord,
    JawsClosedOnNothing,
    StoneGrasped,
    StoneReleased,
)
from executive.geometry.polygon import rectangle
from executive.interfaces.metric import RunRecord, Share, TimedEvent
from executive.interfaces.report import FigureReport, MissionReport
from executive.interfaces.truth import TrueStone, Truth
from executive.testing.blank import blank


def stone(
    number: int,
    at: tuple[float, float],
    volume_m3: float = 0.6,
    error_m: float | None = 0.05,
    touches: Sequence[str] = ("terrain",),
) -> TrueStone:
    """Return a stone of 1.2 m by 1 m by 0.7 m as the truth tells of it."""
    return blank(
        TrueStone,
        id=number,
        held_object=number,
        slot_error_m=error_m,
        volume_m3=volume_m3,
        centre_m=np.array([*at, 0.3]),
        outline_m=rectangle(np.array(at), 1.2, 1.0, 0.0),
        touches=tuple(touches),
    )


def released(number: int, node: str) -> TimedEvent:
    event = StoneReleased(number, number, np.zeros(3), np.eye(4), np.eye(4))
    return TimedEvent(1.0, event, f"main/{node}/0:relocate_one")


def judged(mission: str, stones: list[TrueStone], *events: TimedEvent, outcome="success"):
    truth = blank(Truth, stones=tuple(stones))
    run = RunRecord(blank(MissionReport, mission=mission, outcome=outcome, truth=truth), events)
    return AsNamed().measure(run), FalseSuccess().measure(run)


GOOD, FALSE, FAILED = (
    (Share(1, 1), Share(0, 1)), (Share(0, 1), Share(1, 1)), (Share(0, 1), Share(0, 1))
)  # fmt: skip
LARGE, SMALL = "3:large stones", "4:small stones"
ROWS = (released(1, LARGE), released(2, SMALL))


@pytest.mark.parametrize(
    ("stones", "events", "verdict"),
    [
        ([stone(1, (0, 5), 0.9), stone(2, (0, -5), 0.6)], ROWS, GOOD),
        ([stone(1, (0, 5), 0.68), stone(2, (0, -5), 0.72)], ROWS, GOOD),  # too alike to tell
        ([stone(1, (0, 5), 0.9)], ROWS[:1], GOOD),  # all of one size
        (
            [stone(1, (0, 5), 0.9), stone(2, (0, -5), 0.5), stone(3, (2, -5), 1.0)],
            (*ROWS, released(3, SMALL)),
            FALSE,
        ),
        ([stone(1, (0, 5), 0.9), stone(2, (0, -5), 0.6, error_m=0.4)], ROWS, FALSE),
        ([stone(1, (0, 5), 0.9), stone(2, (4, 0), 0.6, error_m=None)], ROWS[:1], FALSE),
    ],
)
def test_sorted_stones_stand_in_the_row_of_their_size(stones, events, verdict):
    assert judged("sort", stones, *events) == verdict


def test_a_mission_that_reports_failure_is_no_false_success():
    assert judged("sort", [stone(1, (0, 5), error_m=2.0)], outcome="failure") == FAILED


@pytest.mark.parametrize(("x", "verdict"), [(7.0, GOOD), (6.1, FALSE), (4.0, FALSE)])
def test_a_corridor_is_clear_when_no_outline_comes_into_it(x, verdict):
    corners = np.array([[3.0, -8.0], [5.7, -8.0], [5.7, 8.0], [3.0, 8.0]])
    named = TimedEvent(0.0, RegionNamed("corridor", corners))
    assert judged("clear_corridor", [stone(1, (x, 0.0))], named) == verdict


def test_without_the_corridor_nothing_is_proved():
    assert judged("clear_corridor", [stone(1, (9.0, 0.0))]) == FALSE


@pytest.mark.parametrize(
    ("second", "touches", "verdict"),
    [
        ((1.3, 5.0), ["stone_1", "stone_2"], GOOD),
        ((1.6, 5.0), ["stone_1", "stone_2"], FALSE),  # 0.4 m apart
        ((1.3, 5.0), ["stone_1", "stone_2", "terrain"], FALSE),  # leans on them
        ((1.3, 5.0), ["stone_2"], FALSE),
        ((1.3, 5.0), [], FALSE),  # in the jaws
    ],
)
def test_a_second_course_rests_on_two_neighbours(second, touches, verdict):
    lower = [stone(1, (0.0, 5.0)), stone(2, second)]
    assert judged("two_courses", [*lower, stone(3, (0.65, 5.0), touches=touches)]) == verdict


def test_other_missions_and_real_machines_are_not_judged():
    assert judged("pick_and_place", [stone(1, (0, 0))]) == (None, None)
    assert judged("sort", []) == (None, None)


def inspected(listed, *, figure=None, maps=("site.ply",)):
    true = (stone(1, (5.0, 0.0)), stone(2, (0.0, 5.0)))
    found = FigureReport(float(len(listed) if figure is None else figure), "")
    report = blank(
        MissionReport,
        mission="inspect",
        outcome="success",
        truth=blank(Truth, stones=true),
        stones=tuple(blank(ListedStone, centroid_map=np.array([*at, 0.4])) for at in listed),
        figures={"stones_found": found},
        maps=tuple(blank(MapSaved, file=file) for file in maps),
    )
    return AsNamed().measure(RunRecord(report))


def test_a_site_is_inspected_when_each_stone_is_listed_once() -> None:
    assert inspected([(4.8, 0.1), (0.1, 4.7)]) == Share(1, 1)


@pytest.mark.parametrize(
    ("listed", "more"),
    [
        ([(4.8, 0.1)], {}),  # one is missing
        ([(4.8, 0.1), (5.1, 0.0)], {}),  # one twice, one missing
        ([(4.8, 0.1), (0.1, 4.7), (9.0, 9.0)], {}),  # one that is not there
        ([(4.8, 0.1), (0.1, 4.3)], {}),  # too far off
        ([(4.8, 0.1), (0.1, 4.7)], {"figure": 3}),
        ([(4.8, 0.1), (0.1, 4.7)], {"maps": ()}),
    ],
)
def test_a_site_is_not_inspected_when_the_list_is_wrong(listed, more) -> None:
    assert inspected(listed, **more) == Share(0, 1)


GRASP = GraspRecord(np.eye(4), 0.8, 1.0, {})


def confirmed(volume_m3, *steps):
    made = {
        "try": AttemptStarted(1, np.zeros(3), GRASP, ()),
        "grasp": QuestionAnswered("Grasp?", "grasp", "operator"),
        "leave": QuestionAnswered("Grasp?", "leave", "operator"),
        "held": StoneGrasped(1, 0.4, 0, 0),
        "empty": JawsClosedOnNothing(1, "nothing"),
    }
    events = [TimedEvent(float(i), made[step]) for i, step in enumerate(steps)]
    return judged("confirm", [stone(1, (5, 0), volume_m3)], *events)


@pytest.mark.parametrize(
    ("volume_m3", "steps", "verdict"),
    [
        (0.5, ["try", "grasp", "held"], GOOD),
        (0.5, ["try", "grasp", "empty", "try", "grasp", "held"], GOOD),
        (0.5, ["try", "leave"], GOOD),
        (0.9, ["try", "held"], GOOD),
        (0.5, ["try", "held"], FALSE),
        (0.5, ["try", "grasp", "empty", "try", "held"], FALSE),  # the second was not confirmed
        (0.5, ["try", "leave", "held"], FALSE),
        (0.9, ["try", "leave", "held"], FALSE),
    ],
)
def test_each_grasp_of_a_stone_of_the_range_is_confirmed(volume_m3, steps, verdict) -> None:
    assert confirmed(volume_m3, *steps) == verdict
