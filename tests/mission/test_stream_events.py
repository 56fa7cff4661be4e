"""What the streams give rise to is recorded and shown; errors end the mission or are excused."""

from types import SimpleNamespace
from typing import Any

import pytest

from executive.events.mission import (
    EstimatorStatusChanged,
    ObservationIgnored,
    PluginFailed,
    VerdictGiven,
)
from executive.messages.status_change import StatusChange
from executive.messages.verdict import Trouble, Verdict
from executive.mission import plugin_errors
from executive.mission.plugin_errors import PluginErrors
from executive.mission.stream_events import StreamEvents


class Told:
    """What was recorded and shown."""

    def __init__(self, can_fail: frozenset[tuple[str, str]] = frozenset()) -> None:
        self.recorded: list[Any] = []
        self.shown: list[Any] = []
        record = lambda *given: self.recorded.append(given)
        self.errors = PluginErrors({}, can_fail, record)
        self.events = StreamEvents(record, lambda *given: self.shown.append(given), self.errors)


def test_a_verdict_is_kept_shown_and_recorded() -> None:
    told, verdict = Told(), Verdict(3.0, "jaw_slip", Trouble.SLIP, "0.5 m open")
    told.events.take_verdict(verdict)
    assert told.events.verdicts == [verdict]
    assert told.shown == [("verdict", verdict)]
    ((node, event),) = told.recorded
    assert node == ""
    assert repr(event) == repr(VerdictGiven("jaw_slip", Trouble.SLIP, "0.5 m open"))


def test_a_change_of_status_is_shown_and_recorded() -> None:
    told = Told()
    change = StatusChange(before="LOCAL", after="GLOBAL", stamp_s=2.5, reason="a fix")
    told.events.take_status(change)
    assert told.shown == [("estimator", change)]
    event = EstimatorStatusChanged("LOCAL", "GLOBAL", 2.5, "a fix")
    assert repr(told.recorded) == repr([("", event)])


def test_what_nobody_takes_is_recorded() -> None:
    told = Told()
    told.events.take_unknown("Sonar")
    assert repr(told.recorded) == repr([("", ObservationIgnored("Sonar"))])


def test_an_error_ends_the_mission_unless_its_plugin_can_fail(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fault = SimpleNamespace(
        capability="monitoring", name="jaw_slip", node="main/1", summary="s", traceback="t"
    )
    monkeypatch.setattr(plugin_errors, "fault_of", lambda *given: fault)
    error = LookupError("no joint")
    told = Told()
    with pytest.raises(LookupError, match="no joint"):
        told.events.take_error("monitoring", None, error)
    assert told.recorded == []
    told = Told(frozenset({("monitoring", "other")}))
    with pytest.raises(LookupError):
        told.events.take_error("monitoring", None, error)
    told = Told(frozenset({("monitoring", "jaw_slip")}))
    told.events.take_error("monitoring", None, error)
    assert repr(told.recorded) == repr([("main/1", PluginFailed(fault))])
