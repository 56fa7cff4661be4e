"""What is said from a run's start to its end."""

from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer

from executive.commands.missions import starting
from executive.commands.missions.starting import carried_out, startable
from executive.mission import progress
from executive.mission.stop_signals import Aborted

RESULT = SimpleNamespace(
    summary="success after 3 s",
    folder=SimpleNamespace(report=Path("run/report.json")),
    report=SimpleNamespace(payload=lambda: {"outcome": "success"}),
    exit_status=3,
)


@pytest.mark.parametrize("groot", [None, 1667])
@pytest.mark.parametrize("as_json", [False, True])
def test_a_run_says_where_it_is_watched_and_what_came_of_it(monkeypatch, groot, as_json) -> None:
    said, answered, asked = [], [], []
    monkeypatch.setattr(starting, "say", said.append)
    monkeypatch.setattr(starting, "answer", answered.append)
    monkeypatch.setattr(starting, "groot_told", lambda port: f"Groot: {port}")
    monkeypatch.setattr(progress, "progress", lambda quiet: nullcontext(f"shown {not quiet}"))
    made = SimpleNamespace(execute=lambda after, tell: asked.append((after, tell)) or RESULT)
    status = carried_out(made, SimpleNamespace(groot=groot), quiet=as_json, as_json=as_json)
    assert status == 3
    assert said == [
        *([] if groot is None else ["Groot: 1667"]),
        "success after 3 s",
        "  report     run/report.json",
    ]
    assert answered == ([{"outcome": "success"}] if as_json else [])
    assert asked == [(f"shown {not as_json}", said.append)]


def test_a_start_that_is_stopped_ends_with_status_1(monkeypatch) -> None:
    said = []
    monkeypatch.setattr(starting, "say", said.append)
    with pytest.raises(typer.Exit) as ended, startable():
        raise Aborted("stopped before it began")
    assert ended.value.exit_code == 1
    assert said == ["stopped before it began"]
