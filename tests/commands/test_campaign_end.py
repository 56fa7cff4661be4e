"""`executive campaign` at its end: the report, the exit status, and the list of a dry run."""

import json
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.pool import RefusedError
from executive.campaign.trial import Limits, Status, Trial
from executive.commands.campaigns import campaign
from executive.errors import ConfigError
from executive.extras import MissingExtraError

FAILURES = (Status.CRASHED, Status.KILLED, Status.TIMED_OUT, Status.OUT_OF_MEMORY)


@pytest.mark.parametrize(
    ("again", "statuses"),
    [
        ((), ()),
        (["failed"], FAILURES),
        (["killed", "crashed"], (Status.CRASHED, Status.KILLED)),
        (["timed_out", "failed"], FAILURES),
    ],
)
def test_runs_are_repeated_by_their_status(again: Any, statuses: Any) -> None:
    assert campaign._statuses(again, True) == statuses


def test_nothing_is_repeated_without_resume_nor_what_is_done() -> None:
    with pytest.raises(ConfigError, match="--again repeats runs of an earlier session"):
        campaign._statuses(["failed"], False)
    with pytest.raises(ConfigError, match="'done' is not one of crashed, killed, "):
        campaign._statuses(["done"], True)
    assert campaign._statuses((), False) == ()


@pytest.mark.parametrize("error", [DiskFullError("full"), RefusedError(3, "no such plugin"), None])
def test_a_campaign_that_cannot_go_on_says_how_to(
    error: Exception | None, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    given: list[Any] = []

    @contextmanager
    def progress(trials: Any, *, quiet: bool) -> Any:
        given.append((trials, quiet))
        yield "after"

    def run(*words: Any) -> str:
        given.append(words)
        if error:
            raise error
        return "progress"

    monkeypatch.setattr("executive.campaign.engine.run_campaign", run)
    monkeypatch.setattr("executive.commands.campaigns.progress.campaign_progress", progress)
    asked, plan = SimpleNamespace(trials=["a trial"]), SimpleNamespace(folder=Path("my results"))
    if error is None:
        assert campaign._run(asked, plan, "pool", True) == "progress"
        assert capsys.readouterr().err == ""
    else:
        with pytest.raises(type(error)):
            campaign._run(asked, plan, "pool", True)
        told = capsys.readouterr().err
        assert "go on      executive campaign 'my results' --resume" in told
    assert given == [(["a trial"], True), (asked, plan, "pool", "after")]


@pytest.mark.parametrize(
    ("is_complete", "are_met", "status"),
    [(True, True, 0), (True, False, 1), (False, True, 1), (False, False, 1)],
)
def test_the_status_is_0_if_all_has_ended_and_every_bound_is_met(
    is_complete: bool, are_met: bool, status: int, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    judgements = [SimpleNamespace(is_met=True), SimpleNamespace(is_met=are_met)]
    report = SimpleNamespace(
        summary=SimpleNamespace(figures=SimpleNamespace(judgements=judgements))
    )
    written: list[Any] = []
    place = "executive.campaign.reporting"
    monkeypatch.setattr(f"{place}.report.summarise_campaign", lambda folder, asked: report)
    monkeypatch.setattr(f"{place}.report.write_report", lambda *given: written.append(given))
    monkeypatch.setattr(f"{place}.summary.document_of", lambda summary: {"runs": 4})
    monkeypatch.setattr("executive.commands.campaigns.ending.ending", lambda *_: ["4 of 4 runs"])
    progress, folder = SimpleNamespace(is_complete=is_complete), Path("results")
    assert campaign._conclude("asked", folder, progress, True) == status
    told = capsys.readouterr()
    assert told.err == "4 of 4 runs\n  report     results/report.html\n"
    answered = {"folder": "results", "is_complete": is_complete, "are_bounds_met": are_met}
    assert json.loads(told.out) == {**answered, "page": "results/report.html", "runs": 4}
    assert written == [(folder, report)]

    def lacks(*_: Any) -> None:
        raise MissingExtraError("--report", "reports", ("jinja2",), "executive")

    monkeypatch.setattr(f"{place}.report.write_report", lacks)
    assert campaign._conclude("asked", folder, progress, True) == status
    told = capsys.readouterr()
    assert "no page was written: " in told.err
    assert json.loads(told.out)["page"] is None
    campaign._conclude("asked", folder, progress, False)
    assert capsys.readouterr().out == ""


def test_a_dry_run_lists_what_would_be_run(capsys: Any) -> None:
    limits = Limits(1.0, 1)
    trials = [
        Trial(n, "mission", {}, seed, {"length": level}, limits)
        for n, (seed, level) in enumerate(((5, "whole"), (5, "cut"), (6, "whole"), (6, "cut")))
    ]
    asked = SimpleNamespace(name="waiting", digest="abc", trials=trials)
    campaign._list(asked, True)
    told = capsys.readouterr()
    assert told.err.splitlines() == [
        "waiting: 4 runs: 2 seeds, 2 combinations",
        "  run 0  seed 5  length=whole",
        "  run 1  seed 5  length=cut",
        "  run 2  seed 6  length=whole",
        "  run 3  seed 6  length=cut",
    ]
    runs = [{"number": one.number, "seed": one.seed, "levels": one.levels} for one in trials]
    assert json.loads(told.out) == {"campaign": "waiting", "digest": "abc", "runs": runs}
    campaign._list(asked, False)
    assert capsys.readouterr().out == ""


def test_the_folder_of_results_is_the_one_that_was_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "executive.campaign.description.load.is_campaign_folder", lambda what: what == "results"
    )
    assert campaign._folder("a.yaml", None, False) is None
    assert campaign._folder("results", None, False) == Path("results")
    assert campaign._folder("results", tmp_path, False) == tmp_path
    with pytest.raises(ConfigError, match="--resume: name the folder to go on in"):
        campaign._folder("a.yaml", None, True)
    with pytest.raises(ConfigError, match="holds no results of a campaign"):
        campaign._folder("a.yaml", tmp_path, True)
    (tmp_path / "results.sqlite").touch()
    assert campaign._folder("a.yaml", tmp_path, True) == tmp_path
