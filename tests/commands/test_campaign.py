"""`executive campaign` as a person uses it: from the command line to exit status and folder."""

import io
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from rich.console import Console

from executive.campaign.execution.ledger import Ledger
from executive.campaign.execution.progress import Progress, RunningTrial
from executive.campaign.trial import Limits, Outcome, Status, Trial
from executive.commands.campaigns.progress import LiveTable, duration
from executive.commands.main import main

MISSION = """
api: 1
mission: waits
plugins:
  robot: {plugin: kinematic}
  estimation: gnss_imu_filter
trees:
  main: {wait: 1 s}
"""
CAMPAIGN = """
api: 1
campaign: waiting
missions: waits.yaml
seeds: [1, 2]
factors:
  length: {whole: {}, cut: {loop.time_limit: 0.5}}
metrics: {success: {at_least: 0.9, where: {length: whole}}}
"""


@dataclass(frozen=True)
class Answer:
    status: int
    out: str
    err: str


@pytest.fixture
def executive(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., Answer]:
    """Call the command line in this process."""

    def call(*words: str) -> Answer:
        monkeypatch.setattr(sys, "argv", ["executive", *words])
        capsys.readouterr()
        status = 0
        try:
            main()
        except SystemExit as ended:
            status = int(ended.code or 0)
        return Answer(status, *capsys.readouterr())

    return call


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder with a mission that ends in a moment, and a campaign of it."""
    (tmp_path / "waits.yaml").write_text(MISSION)
    (tmp_path / "waiting.yaml").write_text(CAMPAIGN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def tries_of(folder: Path) -> list[int]:
    """Return how often each finished run was begun."""
    ledger = Ledger(folder / "results.sqlite")
    tries = [one.tries for one in ledger.outcomes()]
    ledger.close()
    return tries


def test_a_campaign_runs_is_resumed_and_fails_on_a_missed_bound(
    here: Path, executive: Callable[..., Answer]
) -> None:
    done = executive("campaign", "waiting.yaml", "--out", "results", "--json")
    assert done.status == 0, done.err
    answer = json.loads(done.out)
    assert (answer["folder"], answer["is_complete"]) == ("results", True)
    assert answer["campaign"]["runs"] == {
        "asked": 4,
        "done": 4,
        "without_answer": 0,
        "not_successful": 2,
    }
    assert "\n4/4  run " in done.err
    assert "  run 3 (seed 2, length=cut) failure in " in done.err
    assert "first failure: run 1 (seed 1, length=cut) failure" in done.err
    assert "repeat it  executive run results/runs/1-1/mission.yaml --seed 1" in done.err
    files = {"campaign.yaml", "results.sqlite", "report.html", "figures.json", "results.csv"}
    assert files <= {path.name for path in (here / "results").iterdir()}

    again = executive("campaign", "waiting.yaml", "--out", "results")
    assert again.status == 2
    assert "holds results of this campaign already: --resume goes on" in again.err

    other = executive("campaign", "waiting.yaml", "--seeds", "3", "--out", "results", "--resume")
    assert other.status == 2
    assert "holds another campaign: it has 4 runs, this one has 2" in other.err

    resumed = executive("campaign", "results", "--resume", "--quiet")
    assert resumed.status == 0
    stricter = CAMPAIGN.replace(", where: {length: whole}", "")
    (here / "waiting.yaml").write_text(stricter)
    missed = executive("campaign", "waiting.yaml", "--out", "results", "--resume")
    assert missed.status == 1
    assert "4 of 4 runs have ended before" in missed.err
    assert "missed: success (cut) is 0 %, at least 90 % was asked for" in missed.err
    assert tries_of(here / "results") == [1, 1, 1, 1]


def test_a_dry_campaign_lists_its_runs_and_begins_none(
    here: Path, executive: Callable[..., Answer]
) -> None:
    words = ("--seeds", "1:2", "--vary", "loop.tick=0.1,0.2", "--set", "loop.runner=thread")
    done = executive("campaign", "waits.yaml", *words, "--dry", "--json")
    assert done.status == 0
    runs = json.loads(done.out)["runs"]
    assert [(one["seed"], one["levels"]["loop.tick"]) for one in runs] == [
        (1, "0.1"),
        (1, "0.2"),
        (2, "0.1"),
        (2, "0.2"),
    ]
    assert "waits: 4 runs: 2 seeds, 2 combinations" in done.err
    assert {path.name for path in here.iterdir()} == {"waits.yaml", "waiting.yaml"}


def test_check_takes_campaign_files_as_well(here: Path, executive: Callable[..., Answer]) -> None:
    good = executive("check", "waiting.yaml", "--json")
    assert (good.status, json.loads(good.out)["campaign"]) == (0, "waiting")
    (here / "waiting.yaml").write_text(CAMPAIGN.replace("success:", "sucess:"))
    bad = executive("check", "waiting.yaml", "--json")
    assert bad.status == 2
    (problem,) = json.loads(bad.out)["problems"]
    assert problem.startswith("waiting.yaml:8:11: error: no metric plugin 'sucess'. Did you mean")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["waits.yaml"], "'seeds' is missing"),
        (["waits.yaml", "--seeds", "2:1"], "write 1:2"),
        (["waits.yaml", "--seeds", "1", "--resume"], "--resume: name the folder to go on in"),
        (["waits.yaml", "--seeds", "1", "--resume", "--out", "x"], "x holds no results"),
        (["waits.yaml", "--seeds", "1", "--again", "failed"], "it needs --resume"),
        (["waits.yaml", "--seeds", "1", "--jobs", "2", "--scheduler", "tcp://x:1"], "--jobs: the"),
        (["wats"], "no campaign file, no mission file and no shipped mission of that name"),
    ],
)
def test_wrong_options_are_refused_with_status_2(
    words: list[str], message: str, here: Path, executive: Callable[..., Answer]
) -> None:
    refused = executive("campaign", *words)
    assert refused.status == 2
    assert message in refused.err
    assert not (here / "campaigns").exists()


def test_an_unknown_status_to_repeat_is_refused_with_the_nearest(
    here: Path, executive: Callable[..., Answer]
) -> None:
    words = ("--seeds", "1", "--resume", "--out", ".", "--again", "crash")
    refused = executive("campaign", "waits.yaml", *words)
    assert refused.status == 2
    assert "Did you mean 'crashed'?" in refused.err


def test_the_live_table_shows_what_runs_what_failed_and_the_time_left() -> None:
    limits = Limits(10.0, 10**9)
    trials = [Trial(n, "mission", {}, 40 + n, {"stones": "scans"}, limits) for n in range(30)]
    crash = Outcome(0, Status.CRASHED, reason="segmentation fault", wall_s=12.0)
    done = Outcome(1, Status.DONE, answer={"report": {"outcome": "success"}}, wall_s=75.0)
    running = tuple(RunningTrial(n, 100.0 - n) for n in range(2, 20))
    counts = {Status.CRASHED: 1, Status.DONE: 1}
    progress = Progress(30, counts, running, 3700.0, ended=(crash, done))
    screen = io.StringIO()
    console = Console(file=screen, force_terminal=True, width=100, height=60, color_system=None)
    with LiveTable(trials, console) as table:
        table(progress)
    shown = screen.getvalue()
    assert "2 of 30 runs  1 failed  18 running  about 1 h 01 min left" in shown
    assert "run 0 (seed 40, stones=scans) crashed in 12 s: segmentation fault" in shown
    assert " 2  " in shown
    assert "1 min 38 s" in shown
    assert "and 2 more" in shown


def test_durations_are_said_as_people_say_them() -> None:
    seconds = (0.43, 9.96, 12.2, 59.7, 185, 7620)
    words = ["0.4 s", "10.0 s", "12 s", "1 min 00 s", "3 min 05 s", "2 h 07 min"]
    assert [duration(one) for one in seconds] == words
