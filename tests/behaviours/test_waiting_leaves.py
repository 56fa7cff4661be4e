"""WaitForEvent: what counts, what does not, and when it gives up."""

import pytest

from executive.behaviours.wait_for_event import WaitForEvent
from executive.events.finding import FigureReported
from executive.events.site import SiteScanned


def waiting(stand, schedule, **settings):
    """Tick the leaf while events are recorded at given times [s]."""
    context, due = stand.leaf_context, sorted(schedule, key=lambda one: one[0])
    now_s = context.now_s

    def recording():
        while due and due[0][0] <= context.time_s:
            context.record(due.pop(0)[1])
        return now_s()

    context.now_s = recording
    return stand.tick(WaitForEvent, settings=settings, limit_s=20.0)


def test_the_first_event_of_the_class_ends_the_wait(stage) -> None:
    stand = stage.Stage()
    schedule = [(1.0, FigureReported("a", 1.0, "")), (2.0, SiteScanned(7)), (3.0, SiteScanned(8))]
    ended = waiting(stand, schedule, event="SiteScanned", within="10 s")
    assert ended.status == "SUCCESS"
    assert ended.outputs["event"].points == 7
    assert stand.leaf_context.time_s == pytest.approx(2.0, abs=0.11)


def test_what_happened_before_does_not_count(stage) -> None:
    stand = stage.Stage()
    stand.leaf_context.record(SiteScanned(7))
    ended = waiting(stand, [], event="SiteScanned", within="3 s")
    assert (ended.status, ended.reason) == ("FAILURE", "no SiteScanned within 3 s")
    assert stand.leaf_context.time_s == pytest.approx(3.0, abs=0.11)


@pytest.mark.parametrize(
    "bounds",
    [
        {"equals": {"name": "b"}},
        {"at_least": {"value": 1.5}},
        {"at_least": {"value": 1.5}, "at_most": {"value": 2.0}},
        {"equals": {"name": "b", "unit": "m"}},
    ],
)
def test_conditions_choose_the_event(stage, bounds) -> None:
    schedule = [(1.0, FigureReported("a", 1.0, "")), (2.0, FigureReported("b", 2.0, "m"))]
    ended = waiting(stage.Stage(), schedule, event="FigureReported", within="10 s", **bounds)
    assert ended.outputs["event"].name == "b"


def test_a_bound_on_what_is_no_number_is_never_met(stage) -> None:
    schedule = [(1.0, FigureReported("a", 1.0, ""))]
    ended = waiting(
        stage.Stage(), schedule, event="FigureReported", within="2 s", at_least={"name": 0.0}
    )
    assert ended.reason == "no FigureReported with name ≥ 0 within 2 s"


def test_without_a_limit_it_waits_on(stage) -> None:
    assert waiting(stage.Stage(), [], event="SiteScanned").status == "INVALID"  # halted


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"event": "SiteScaned"}, "no event 'SiteScaned'. Did you mean 'SiteScanned'?"),
        (
            {"event": "SiteScanned", "equals": {"point": 3}},
            "SiteScanned has no field 'point'. Did you mean 'points'?",
        ),
    ],
)
def test_an_unknown_event_or_field_is_refused_when_the_mission_is_checked(settings, told) -> None:
    with pytest.raises(ValueError, match="validation error") as refused:
        WaitForEvent.Settings(**settings)
    assert told in str(refused.value)
