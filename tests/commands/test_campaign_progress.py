"""Progress of a campaign says what ended, what runs, and what it waits for."""

import io

import pytest
from rich.console import Console

from executive.campaign.execution.progress import Progress, RunningTrial
from executive.campaign.trial import Limits, Outcome, Status, Trial
from executive.commands.campaigns import progress as progress_module
from executive.commands.campaigns.progress import (
    LiveTable,
    PlainLines,
    SilentProgress,
    campaign_progress,
    duration,
    time_left,
)

TRIALS = [Trial(0, "mission", {}, 1, {}, Limits(1.0, 1))]


def test_a_cluster_without_workers_is_told_once(capsys: pytest.CaptureFixture[str]) -> None:
    nothing = Progress(total=1, counts={}, running=(), left_s=None)
    running = Progress(total=1, counts={}, running=(RunningTrial(0, 0.1),), left_s=None)
    lines = PlainLines(TRIALS)
    for progress in (nothing, nothing, running, running, nothing):
        lines(progress)
    assert capsys.readouterr().err == "waiting for a worker\n" * 2


def trials(count: int) -> list[Trial]:
    return [
        Trial(n, "mission", {}, 40 + n, {"stones": "scans"} if n else {}, Limits(1.0, 1))
        for n in range(count)
    ]


def outcome(number: int, outcome: str = "success", status: Status = Status.DONE) -> Outcome:
    answer = {"report": {"outcome": outcome, "reason": "no\n way"}} if status is Status.DONE else {}
    reason = "" if status is Status.DONE else "x" * 400
    return Outcome(number, status, reason, answer, wall_s=75.0)


def test_each_run_that_ended_is_a_line_with_its_number_among_all(
    capsys: pytest.CaptureFixture[str],
) -> None:
    lines = PlainLines(trials(120))
    running = (RunningTrial(9, 1.0),)
    with lines as shown:
        shown(Progress(120, {Status.DONE: 7}, running, None, resumed=7))
        ended = (outcome(0), outcome(1, "failure"))
        shown(Progress(120, {Status.DONE: 9}, running, None, resumed=7, ended=ended))
        shown(Progress(120, {Status.DONE: 9}, running, None, resumed=7))
        crashed = (outcome(2, status=Status.OUT_OF_MEMORY),)
        shown(Progress(120, {Status.DONE: 9}, running, None, resumed=7, ended=crashed))
    assert capsys.readouterr().err.splitlines() == [
        "7 of 120 runs have ended before",
        "  8/120  run 0 (seed 40) success in 1 min 15 s",
        "  9/120  run 1 (seed 41, stones=scans) failure in 1 min 15 s: no way",
        f" 10/120  run 2 (seed 42, stones=scans) out of memory in 1 min 15 s: {'x' * 299}…",
    ]


class Picture(LiveTable):
    """A live table on paper, 100 columns wide, whose wall clock is set."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, count: int) -> None:
        self.wall_s, self.drawn = 100.0, 0
        monkeypatch.setattr(progress_module, "wall_s", lambda: self.wall_s)
        super().__init__(trials(count))
        self._live = self

    def update(self, picture: object, refresh: bool) -> None:
        assert refresh
        self.drawn += 1
        paper = io.StringIO()
        Console(file=paper, width=100).print(picture)
        self.lines = [line.rstrip() for line in paper.getvalue().splitlines()]


def test_the_table_shows_counts_the_oldest_runs_first_and_the_last_failures(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    picture = Picture(monkeypatch, 40)
    ended = tuple(
        outcome(n, "failure" if n % 2 else "success", Status.DONE if n < 7 else Status.KILLED)
        for n in range(9)
    )
    running = tuple(RunningTrial(n, float(n)) for n in (20, 30, 25))
    counts = {Status.DONE: 7, Status.KILLED: 2}
    picture(Progress(40, counts, running, 600.0, ended=ended))
    head, titles, *rest = picture.lines
    assert head.startswith("9 of 40 runs  5 failed  3 running  about 10 min 00 s left")
    assert titles.split() == ["run", "seed", "levels", "for"]
    rows = [line.split() for line in rest[:3]]
    assert rows == [
        ["30", "70", "stones=scans", "30", "s"],
        ["25", "65", "stones=scans", "25", "s"],
        ["20", "60", "stones=scans", "20", "s"],
    ]
    assert rest[3] == "last failures"
    failures = [line.split()[1] for line in rest if line.startswith("  run ")]
    assert failures == ["1", "3", "5", "7", "8"]


def test_of_many_runs_and_failures_the_table_shows_some(monkeypatch: pytest.MonkeyPatch) -> None:
    picture = Picture(monkeypatch, 40)
    ended = tuple(outcome(n, "fault") for n in range(8))
    running = tuple(RunningTrial(n, 100.0 - n) for n in range(10, 28))
    picture(Progress(40, {Status.DONE: 8}, running, None, ended=ended))
    numbers = [line.split()[0] for line in picture.lines[2:18]]
    assert numbers == [str(n) for n in range(10, 26)]
    assert picture.lines[18].split() == ["and", "2", "more"]
    failures = [line.split()[1] for line in picture.lines[20:]]
    assert failures == [str(n) for n in range(2, 8)]
    assert "8 failed" in picture.lines[0]


def test_a_table_without_a_run_says_what_it_waits_for(monkeypatch: pytest.MonkeyPatch) -> None:
    picture = Picture(monkeypatch, 2)
    picture(Progress(2, {}, (), None))
    assert picture.lines[0].startswith("0 of 2 runs  0 failed  waiting for a worker")
    picture(Progress(2, {Status.DONE: 2}, (), 0.0))
    assert picture.lines[0].startswith("2 of 2 runs  0 failed  0 running")
    picture(Progress(2, {Status.DONE: 1}, (), None, stopped_by="SIGINT"))
    assert picture.lines[0].startswith("1 of 2 runs  0 failed  0 running")
    assert len(picture.lines) == 1


def test_a_table_is_drawn_four_times_a_second_and_when_nothing_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    picture, drawn = Picture(monkeypatch, 2), []
    running = (RunningTrial(0, 1.0),)
    for passed_s, now in [(0.0, running), (0.125, running), (0.0, ()), (0.25, running)]:
        picture.wall_s += passed_s
        picture(Progress(2, {}, now, None))
        drawn.append(picture.drawn)
    assert drawn == [1, 1, 2, 3]


def test_the_progress_suits_standard_error(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    for terminal, quiet, kind in [
        (Terminal(), True, SilentProgress), (Terminal(), False, LiveTable),
        (io.StringIO(), False, PlainLines),
    ]:  # fmt: skip
        monkeypatch.setattr("sys.stderr", terminal)
        assert type(campaign_progress(TRIALS, quiet=quiet)) is kind


@pytest.mark.parametrize(
    ("seconds", "told"),
    [
        (0.44, "0.4 s"),
        (9.94, "9.9 s"),
        (10.0, "10 s"),
        (59.4, "59 s"),
        (59.6, "1 min 00 s"),
        (185.0, "3 min 05 s"),
        (3599.4, "59 min 59 s"),
        (3600.0, "1 h 00 min"),
        (7620.0, "2 h 07 min"),
    ],
)
def test_a_duration_is_told_as_people_say_it(seconds: float, told: str) -> None:
    assert duration(seconds) == told
    assert time_left(seconds) == f"about {told} left"


def test_nothing_is_told_of_a_time_that_is_not_known() -> None:
    assert time_left(None) == time_left(0.0) == ""
