"""What the sections of a campaign's page say, each by itself."""

import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import pytest

from executive.campaign.figures.bound import Bound
from executive.campaign.figures.figures import Difference, Estimate, Interval, Judgement
from executive.campaign.reporting.campaign_comparison import differences_answer, differences_text
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.charts.spec import MOST_ROWS
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.sections import failures as failing
from executive.campaign.reporting.sections.chart_notes import left_out, limit_on
from executive.campaign.reporting.sections.differences import compared, difference, interval_of
from executive.campaign.reporting.sections.failures import failures
from executive.campaign.reporting.sections.tables import (
    estimate_tables,
    not_measured,
    resource_table,
)
from executive.campaign.reporting.sections.verdicts import verdicts
from executive.campaign.reporting.summary import MetricWords, read_summary
from executive.campaign.trial import Limits, Status, Trial
from executive.errors import DataError

SUCCESS = MetricWords("missions that succeed", "", True, True, "")
TIME = MetricWords("cycle time", "s", False, False, "")
CELLS = Cells({"kind": ("a", "b")})
NAN = math.nan


def text(parts):
    """Return the text of markup: cells are parted by bars."""
    whole = "\n".join(map(str, parts)).replace("</td><td", " | </td><td")
    return re.sub(r"<[^>]*>", "", whole.replace("</tr>", "\n").replace("</p>", "\n"))


def summary(judgements=(), estimates=(), missing=0, **metrics):
    return SimpleNamespace(
        figures=SimpleNamespace(judgements=judgements, estimates=estimates, differences=()),
        campaign=SimpleNamespace(
            runs=SimpleNamespace(missing=missing),
            factors=CELLS.factors,
            metrics=metrics or {"success": SUCCESS, "time": TIME},
        ),
    )


def judged(is_met=True, is_sure=True, level="a", bound=None):
    bound = bound or Bound("success", "share", 0.95, True)
    return Judgement(bound, {"kind": level}, 0.9, Interval(0.8, 0.97), is_met, is_sure)


def test_a_campaign_without_bounds_says_so():
    assert text(verdicts(summary())) == "This campaign sets no bounds.\n"


def test_missed_bounds_come_first_and_are_counted():
    told = text(verdicts(summary((judged(level="a"), judged(False, False, "b")))))
    assert told.startswith("1 of 2 bounds missed.")
    first, second = (line for line in told.splitlines() if "≥ 95 %" in line)
    assert first.endswith(
        "missed, not sure | missions that succeed | b | ≥ 95 % | 90 % | 80 to 97 %"
    )
    assert second == "met | missions that succeed | a | ≥ 95 % | 90 % | 80 to 97 %"
    assert "All 1 bound met so far." in text(verdicts(summary((judged(),), missing=3)))


def test_a_bound_on_values_names_its_statistic():
    bound = Bound("time", "p95", 30.0, False)
    one = replace(judged(bound=bound), value=28.5, interval=Interval(NAN, 33.0))
    told = text(verdicts(summary((one,))))
    assert "met | cycle time, p95 | a | ≤ 30 s | 28.5 s | ≤ 33 s" in told


def test_of_more_than_twenty_bounds_those_that_are_met_are_folded():
    many = [judged(number != 3) for number in range(20)]
    assert "<details>" not in "".join(verdicts(summary(many)))
    whole = "".join(verdicts(summary([*many, judged()])))
    assert whole.count("missed</span>") == 1
    open_, _, folded = whole.partition("<details>")
    assert "20 bounds met" in folded
    assert "missed</span>" in open_
    assert folded.count(">met</span>") == 20
    all_met = "".join(verdicts(summary([judged()] * 21)))
    assert "21 bounds met" in all_met


def estimate(metric="time", level="a", **fields):
    given = {"runs": 10, "without_answer": 1, "measured": 10, "hits": 0, "of": 30,
             "statistics": {}, "assumed": 0, "problems": 0}  # fmt: skip
    return Estimate(metric, {"kind": level}, **(given | fields))


def test_figures_are_told_with_their_numbers():
    share = estimate("success", hits=9, of=10, statistics={"share": (0.9, Interval(0.6, 0.98))})
    some = {"median": (3.0, Interval(2.0, 4.0)), "max": (9.0, Interval(9.0, NAN))}
    told = text(estimate_tables(summary((), (share, estimate(statistics=some))), CELLS))
    assert "a | 90 % | 60 to 98 % | 9 | 10 | 10 | 1" in told
    assert "a | 3 s (2 to 4 s) | – | – | 9 s | 30 | 10 | 1" in told


def test_a_metric_without_a_value_has_no_table():
    assert estimate_tables(summary((), (estimate(of=0),)), CELLS) == []


def result(number=0, status=Status.DONE, outcome="success", reason="", tries=1, **row):
    given = {"has_answer": status is Status.DONE, "problems": {}, "measurements": {}}
    trial = Trial(number, "mission", {}, 100 + number, {"kind": "a"}, Limits(60.0, 10**9))
    return Result(trial, SimpleNamespace(**(given | row)), status, outcome, reason,
                  2.0 + number, 1.0, 2**20, tries, "here")  # fmt: skip


def test_what_runs_took_is_told_by_its_median_and_its_most():
    told = text([resource_table({"a": [result(0), result(2), result(1)]}, CELLS)])
    assert "a | 3 | 3 s | 4 s | 1 s | 1 s | 1 MiB | 1 MiB" in told


def test_what_was_not_measured_is_told_with_the_first_error():
    runs = [result(), result(1, problems={"time": "no stamp"}), result(2, problems={"time": "x"})]
    told = text(not_measured(summary((), (), missing=2), runs, CELLS))
    assert "missions that succeed: no figure" in told
    assert "cycle time: 2 errors, first: no stamp" in told
    assert "2 runs of the campaign have not ended." in told
    few = [estimate(measured=0), estimate(level="b", measured=0)]
    told = text(not_measured(summary((), few, time=TIME), [], CELLS))
    assert told == "cycle time: no run holds anything to measure it on"
    few = [estimate(measured=9), estimate(level="b", measured=10)]
    told = text(not_measured(summary((), few, time=TIME), [], CELLS))
    assert told == "cycle time: nothing to measure in a: 1 of 10 runs"
    every = text(not_measured(summary((), [estimate()], time=TIME), [], CELLS))
    assert every == "Every metric was measured on every run.\n"


def test_of_more_than_six_cells_that_lack_a_figure_the_others_are_counted():
    few = [estimate(measured=9, level=str(number)) for number in range(8)]
    told = text(not_measured(summary((), few, time=TIME), [], CELLS))
    assert told.endswith("5: 1 of 10 runs; 2 more cells")
    told = text(not_measured(summary((), few[:6], time=TIME), [], CELLS))
    assert told.endswith("5: 1 of 10 runs")


@pytest.fixture
def quiet(monkeypatch):
    monkeypatch.setattr(failing, "repetition", lambda folder, one: f"again {one.trial.seed}")


def test_where_nothing_failed_it_is_said(tmp_path, quiet):
    told = text(failures(tmp_path, [result(), result(1, outcome="")], CELLS))
    assert told == "None: every run has an answer, and every mission succeeded.\n"


def test_runs_without_an_answer_come_before_missions_without_success(tmp_path, quiet):
    runs = [
        result(0, outcome="failure", reason="dropped stone 3"),
        result(1, outcome="failure", reason="dropped stone 4"),
        result(2, Status.CRASHED, "", "out of memory", tries=2),
        result(3),
    ]
    told = text(failures(tmp_path, runs, CELLS))
    assert told.startswith("1 run without an answer and 2 missions without success, of 4 runs.")
    assert "failure | dropped stone # | 2 | 100–101" in told
    assert "crashed | out of memory | 1 | 102" in told
    assert told.index("Run 2: crashed") < told.index("Run 0: failure")
    assert "kind=a, seed 102, after 4.0 s, try 2" in told
    assert "kind=a, seed 100, after 2.0 s\n" in told
    assert "again 102" in told


def test_of_many_failures_some_are_shown_some_listed_and_the_others_counted(
    tmp_path, quiet, monkeypatch
):
    monkeypatch.setattr(failing, "MOST_SHOWN", 2)
    monkeypatch.setattr(failing, "MOST_LISTED", 4)
    monkeypatch.setattr(failing, "_MOST_REASONS", 3)
    runs = [result(i, outcome="failure", reason="abcde"[i]) for i in range(5)]
    told = text(failures(tmp_path, runs, CELLS))
    assert told.count("again ") == 2
    assert "2 | failure | c | a | 102" in told
    assert "3 | failure | d | a | 103" in told
    assert "4 | failure" not in told
    assert "1 further run that failed: see results.csv." in told
    assert "2 further reasons are not listed." in told
    told = text(failures(tmp_path, runs[:3], CELLS))
    assert "further" not in told


def test_a_chart_says_how_many_rows_it_leaves_out():
    assert left_out(MOST_ROWS) == []
    assert text(left_out(MOST_ROWS + 1)).startswith("1 further row: see the tables")


def test_the_limit_of_a_bound_is_that_of_its_cell_and_statistic():
    bound = Bound("time", "p95", 30.0, False)
    found = summary((judged(), judged(bound=bound)))
    assert limit_on(found, estimate(), "p95") == 30.0
    assert limit_on(found, estimate(), "median") is None
    assert limit_on(found, estimate(level="b"), "p95") is None
    assert limit_on(found, estimate("success"), "share") == 0.95


def differing(metric="success", **fields):
    given = {"factor": "campaign", "baseline": "old", "level": "new", "others": {"kind": "a"},
             "pairs": 20, "better": 3, "worse": 1, "difference": 0.1,
             "interval": Interval(0.0, 0.2), "verdict": "better", "words": "It is better.",
             "left_out": 0, "p_value": NAN}  # fmt: skip
    return Difference(metric, **(given | fields))


def test_differences_are_told_cell_by_cell():
    of_all = differing("cycle_time", others={}, difference=-2.0, interval=Interval(-3.0, NAN))
    lines = differences_text([differing(), of_all]).splitlines()
    assert lines[0] == "new against old"
    told = " (kind=a): +10.0 points (+0.0 to +20.0 points), 20 pairs, 3 better, 1 worse"
    assert lines[1].endswith(told)
    assert lines[2] == "    It is better."
    assert lines[3].endswith(": -2 s (≥ -3 s), 20 pairs, 3 better, 1 worse")
    (first, second) = json.loads(json.dumps(differences_answer([differing(), of_all])))
    assert (first["pairs"], first["p_value"]) == (20, None)
    assert second["interval"] == {"low": -3.0, "high": None}


def test_a_difference_has_its_sign_and_its_cell():
    assert difference(differing(difference=2.0), TIME) == "+2 s"
    assert difference(differing(difference=0.0), TIME) == "0 s"
    assert interval_of(differing(interval=Interval(-1.0, 2.0)), TIME) == "-1 to 2 s"
    assert compared(differing(), CELLS) == "new, a"
    assert compared(differing(others={}), CELLS) == "new"
    assert compared(differing(others={"kind": "a"}), Cells({"kind": ("a",)})) == "new"


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (None, "there is no such summary of a campaign"),
        ("{", "not a summary of a campaign: "),
        ("[]", "not a summary of a campaign of schema 1"),
        ('{"schema": 2}', "not a summary of a campaign of schema 1"),
        ('{"schema": 1, "campaign": {}, "figures": {}}', "campaign.name: Field required"),
    ],
)
def test_a_file_that_is_no_summary_is_refused(tmp_path, content, told):
    path = tmp_path / "figures.json"
    if content is not None:
        path.write_text(content)
    with pytest.raises(DataError, match=re.escape(told)):
        read_summary(path)
