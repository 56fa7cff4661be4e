"""Reading what a run left behind, and metrics of other packages."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from executive import registry
from executive.campaign.figures.measurement import (
    _plain,
    measure,
    measurements_from,
    metric,
    record_of,
)
from executive.campaign.figures.row import row_of
from executive.campaign.trial import Limits, Outcome, Status, Trial
from executive.errors import ConfigError, DataError
from executive.events.mission import Fault, MissionEnded
from executive.interfaces.metric import RunRecord, Share, Values
from executive.interfaces.report import Counts, CutOffReport, FigureReport, MissionReport
from executive.interfaces.report_file import REPORT, write_report
from executive.journal import Journal
from executive.testing.blank import blank

OTHERS = """
from executive.interfaces.metric import Metric, Share, Values


class Colour(Metric):
    title = "colour"
    is_share = True

    def measure(self, run):
        return Share(run.report.counts.slips, 3)


class Broken(Metric):
    title = "broken"

    def measure(self, run):
        return Values((1.0 / run.report.counts.drops,))


class Endless(Metric):
    title = "endless"

    def measure(self, run):
        return Values((float("inf"),))


class Swapped(Metric):
    title = "swapped"
    is_share = True

    def measure(self, run):
        return Values((1.0,))


class NoMetric:
    pass
"""


@pytest.fixture
def others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Install a package with metrics of its own."""
    folder = tmp_path / "site"
    info = folder / "others.egg-info"
    info.mkdir(parents=True)
    (folder / "other_metrics.py").write_text(OTHERS)
    (info / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: others\nVersion: 0.1\n")
    classes = ("Colour", "Broken", "Endless", "Swapped", "NoMetric")
    points = "".join(f"{one.lower()} = other_metrics:{one}\n" for one in classes)
    (info / "entry_points.txt").write_text(f"[executive.metric.v1]\n{points}")
    monkeypatch.syspath_prepend(str(folder))
    registry.reread()
    yield
    monkeypatch.undo()
    registry.reread()


@pytest.fixture
def run_folder(tmp_path: Path) -> Path:
    folder = tmp_path / "run"
    folder.mkdir()
    report = blank(MissionReport, outcome="success", counts=blank(Counts, slips=2))
    write_report(folder / REPORT, report)
    journal = Journal(folder / "journal.jsonl")
    journal.append(3, 1.5, "main/0:Localise", MissionEnded("success", ""))
    journal.append(4, 2.0, "", MissionEnded("success", ""))
    journal.close()
    return folder


def test_reads_report_and_journal(run_folder: Path) -> None:
    record = record_of(run_folder)
    assert record.report.outcome == "success"
    assert [(one.time_s, one.node) for one in record.events] == [
        (1.5, "main/0:Localise"),
        (2.0, ""),
    ]


def change(path: Path, old: str, new: str) -> None:
    path.write_text(path.read_text().replace(old, new, 1))


def cut_off(folder: Path) -> None:
    short = CutOffReport("m", "fault", "killed", blank(Fault))
    (folder / REPORT).write_text(json.dumps(short.payload()))


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda f: (f / "report.json").unlink(), r"report\.json: there is no report"),
        (lambda f: (f / "report.json").write_text("{"), r"report\.json: not a report of a run"),
        (lambda f: (f / "report.json").write_text("[]"), r"report\.json: .* expected a mapping"),
        (cut_off, r"report\.json: the run was cut off: killed; nothing can be measured"),
        (lambda f: (f / "journal.jsonl").unlink(), r"journal\.jsonl: there is no journal"),
        (lambda f: change(f / "journal.jsonl", "1.5", "1.6"), r"journal\.jsonl:1: the line or one"),
        (lambda f: (f / "journal.jsonl").write_bytes(b"\xff\n"), r"journal\.jsonl:1: not a line"),
    ],
)
def test_damaged_files_are_told_with_their_place(
    run_folder: Path, damage: Callable[[Path], None], message: str
) -> None:
    damage(run_folder)
    with pytest.raises(DataError, match=message):
        record_of(run_folder)


@pytest.mark.usefixtures("others")
def test_a_metric_of_another_package_is_measured(run_folder: Path) -> None:
    assert measure(record_of(run_folder), ["colour"]) == {"colour": {"hits": 2, "of": 3}}


@pytest.mark.usefixtures("others")
def test_a_metric_that_raises_costs_that_metric_alone_and_names_its_line(
    run_folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    found = measure(record_of(run_folder), ["broken", "success", "endless", "swapped"])
    assert found["success"] == {"hits": 1, "of": 1}
    assert "ZeroDivisionError" in found["broken"]["problem"]
    assert "Traceback (most recent call last)" in caplog.text
    assert "other_metrics.py:17" in found["broken"]["problem"]
    assert "not finite" in found["endless"]["problem"]
    assert "expected Share, got Values" in found["swapped"]["problem"]
    measurements, problems = measurements_from(json.loads(json.dumps(found)))
    assert measurements == {"success": Share(1, 1)}
    assert set(problems) == {"broken", "endless", "swapped"}


@pytest.mark.usefixtures("others")
def test_an_unknown_metric_and_one_that_is_none_are_refused() -> None:
    record = RunRecord(blank(MissionReport))
    with pytest.raises(ConfigError, match="Did you mean 'success'"):
        measure(record, ["sucess"])
    with pytest.raises(ConfigError, match="NoMetric does not derive from Metric"):
        measure(record, ["nometric"])


def test_measurements_survive_json() -> None:
    found, problems = measurements_from({"a": {"hits": 1, "of": 2}, "b": {"values": [1, 2.5]}})
    assert found == {"a": Share(1, 2), "b": Values((1.0, 2.5))}
    assert problems == {}
    with pytest.raises(DataError, match=r"metric 'c': .* is no measurement"):
        measurements_from({"c": {"hits": 1}})


def trial() -> Trial:
    return Trial(4, "mission", {}, 9, {"filter": "a"}, Limits(1.0, 1))


def test_a_row_says_how_its_run_ended() -> None:
    answer = {"report": {"outcome": "fault"}, "measurements": {"success": {"hits": 0, "of": 1}}}
    done = row_of(trial(), Outcome(4, Status.DONE, answer=answer))
    assert (done.number, done.seed, done.levels) == (4, 9, {"filter": "a"})
    assert (done.has_answer, done.is_faulted) == (True, True)
    assert done.measurements == {"success": Share(0, 1)}
    killed = row_of(trial(), Outcome(4, Status.KILLED, "signal 9"))
    assert (killed.has_answer, killed.is_faulted, killed.measurements) == (False, False, {})


def test_a_figure_that_the_mission_reports_is_a_metric() -> None:
    report = blank(MissionReport, figures={"stones_found": FigureReport(4.0, "")})
    measured = measure(RunRecord(report), ["figure.stones_found", "figure.other"])
    assert measured == {"figure.stones_found": {"values": [4.0]}}
    assert metric("figure.stones_found").title == "figure stones_found"
    assert metric("figure.other").title == "figure other"


@pytest.mark.parametrize(
    ("found", "told"),
    [
        (Share(3, 2), "3 hits of 2 are no share"),
        (Share(-1, 2), "-1 hits of 2 are no share"),
        (Values((1.0,)), "expected Share, got Values"),
        (Share(0, 0), None),
        (Share(2, 2), None),
    ],
)
def test_a_share_has_no_more_hits_than_trials(found: object, told: str | None) -> None:
    asked = registry.load(registry.METRICS, "success")()
    if told is None:
        assert _plain(found, asked) == {"hits": found.hits, "of": found.of}
        return
    with pytest.raises((ValueError, TypeError), match=told):
        _plain(found, asked)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_a_value_is_finite(value: float) -> None:
    asked = registry.load(registry.METRICS, "cycle_time")()
    assert _plain(Values((1, 2.5)), asked) == {"values": [1.0, 2.5]}
    with pytest.raises(ValueError, match="a value is not finite"):
        _plain(Values((1.0, value)), asked)


def test_a_journal_that_cannot_be_read_is_told(run_folder: Path) -> None:
    (run_folder / "journal.jsonl").unlink()
    (run_folder / "journal.jsonl").mkdir()
    with pytest.raises(DataError, match=r"journal\.jsonl: not a journal: "):
        record_of(run_folder)
