"""What is told at the end of a campaign: its runs, figures and bounds, and how to go on."""

import math
from pathlib import Path

import pytest

from executive.campaign.execution.progress import Progress
from executive.campaign.figures.bound import Bound
from executive.campaign.figures.figures import (
    Difference,
    Estimate,
    Figures,
    Interval,
    Judgement,
)
from executive.campaign.figures.row import Row
from executive.campaign.reporting.report import CampaignReport
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.summary import Head, MetricWords, Runs, Summary
from executive.campaign.trial import Limits, Status, Trial
from executive.commands.campaigns.ending import _runs, _shortened, ending

FACTORS = {"plugins.grasping": ("old", "new"), "plugins.robot": ("only",)}
METRICS = {
    "success": MetricWords("Success", "", True, True, ""),
    "cycle": MetricWords("Cycle", "s", False, False, ""),
    "clearance": MetricWords("Clearance", "m", False, True, ""),
}
NOTHING_KNOWN = Interval(math.nan, math.nan)
FOLDER = Path("out/my runs")


@pytest.mark.parametrize(
    ("without_answer", "not_successful", "told"),
    [
        (0, 0, "7 of 10 runs ended"),
        (0, 2, "7 of 10 runs ended; 2 without success, 0 without an answer "),
        (1, 0, "8 of 10 runs ended; 0 without success, 1 without an answer "),
        (1, 2, "8 of 10 runs ended; 2 without success, 1 without an answer "),
    ],
)
def test_runs_without_success_or_answer_are_told_where_there_are_any(
    without_answer, not_successful, told
):
    words = _runs(Runs(10, 7, without_answer, not_successful))
    assert words.startswith(told)
    assert ("both count as failed" in words) == bool(without_answer or not_successful)


def test_of_more_than_forty_lines_the_rest_is_left_to_the_report():
    lines = [str(i) for i in range(42)]
    assert _shortened(lines[:40]) == lines[:40]
    assert _shortened(lines[:41]) == [*lines[:40], "  … and 1 more, in the report"]
    assert _shortened(lines) == [*lines[:40], "  … and 2 more, in the report"]


def levels(grasping):
    return {"plugins.grasping": grasping, "plugins.robot": "only"}


def estimate(metric, grasping="old", of=20, **more):
    given = {
        "hits": 0,
        "measured": of,
        "without_answer": 0,
        "statistics": {},
        "assumed": 0,
        "problems": 0,
    } | more
    return Estimate(metric=metric, levels=levels(grasping), runs=10, of=of, **given)


def difference(others, *, pairs=10):
    return Difference(
        "success", "plugins.grasping", "old", "new", others, pairs, 0, 0, 0.0, NOTHING_KNOWN,
        "alike", "no difference that matters", 0, math.nan,
    )  # fmt: skip


def judged(statistic, value, *, metric="success", is_least=True, is_met=False, is_sure=True, at=()):
    bound = Bound(metric, statistic, 0.9, is_least)
    return Judgement(bound, dict(at), value, NOTHING_KNOWN, is_met, is_sure)


def result(number, outcome, status=Status.DONE, *, work="mission", **arguments):
    trial = Trial(number, work, arguments, 7, {"stones": "scans"}, Limits(1.0, 1))
    row = Row(number, 7, trial.levels, status is Status.DONE, {})
    return Result(trial, row, status, outcome, "fell\n over", 63.0, 1.0, 1, 1, "")


def told(*, runs=None, estimates=(), differences=(), judgements=(), results=(), left=0):
    figures = Figures(tuple(estimates), tuple(differences), tuple(judgements))
    head = Head("grip", "", "", (), (), "", (), FACTORS, METRICS, runs or Runs(10, 10, 0, 0))
    progress = Progress(10, {Status.DONE: 10 - left}, (), None)
    report = CampaignReport(Summary(head, figures), results)
    return list(ending(FOLDER, report, progress))


def test_a_campaign_without_figures_tells_its_runs_and_its_folder():
    assert told() == ["grip: 10 of 10 runs ended", "  folder     out/my runs"]


def test_each_figure_is_told_with_its_cell_interval_and_number():
    estimates = [
        estimate("success", hits=15, statistics={"share": (0.75, Interval(0.5, 0.9))}),
        estimate("success", "new", hits=20, statistics={"share": (1.0, NOTHING_KNOWN)}),
        estimate("cycle", of=8, statistics={
            "p95": (90.0, Interval(80.0, math.nan)), "median": (60.5, Interval(55.0, 65.0)),
            "max": (99.0, NOTHING_KNOWN),
        }),
        estimate("cycle", "new", of=0),
        estimate("clearance", of=0),
    ]  # fmt: skip
    assert told(estimates=estimates)[1:-1] == [
        "  success  old  75 % (50 to 90 %); 15 of 20 in 10 runs",
        "  success  new  100 %; 20 of 20 in 10 runs",
        "  cycle    old  median 60.5 s (55 to 65 s), p95 90 s (≥ 80 s); 8 values in 10 runs",
        "  nothing to measure: clearance",
    ]


def test_where_metrics_are_bounded_or_compared_the_others_are_left_to_the_report():
    share = {"share": (0.75, NOTHING_KNOWN)}
    estimates = [
        estimate("clearance", statistics={"median": (1.0, NOTHING_KNOWN)}),
        estimate("success", statistics=share),
        estimate("cycle", statistics={"median": (60.0, NOTHING_KNOWN)}),
        estimate("cycle", "new", statistics={"median": (61.0, NOTHING_KNOWN)}),
    ]
    bounded = told(estimates=estimates, judgements=[judged("share", 0.95, is_met=True)])
    assert [line.split()[0] for line in bounded[1:-2]] == ["success", "2"]
    assert bounded[2] == "  2 more metrics in the report"
    compared = told(estimates=estimates, differences=[difference({}, pairs=0)])
    assert compared[1:-1] == bounded[1:3]


def test_a_level_is_compared_where_runs_can_be_paired():
    differences = [
        difference({}), difference({"plugins.grasping": "new"}), difference({}, pairs=0),
    ]  # fmt: skip
    assert told(differences=differences)[1:-1] == [
        "  success: new against old: no difference that matters",
        "  success: new against old at new: no difference that matters",
    ]


def test_each_missed_bound_is_told_with_its_figure():
    judgements = [
        judged("share", 0.85, at=levels("new").items()),
        judged("share", math.nan, is_sure=False),
        judged("p95", 1.25, metric="cycle", is_least=False),
        judged("share", 0.95, is_met=True),
    ]
    assert told(judgements=judgements)[1:-1] == [
        "missed: success (new) is 85 %, at least 90 % was asked for",
        "missed: success has nothing to measure, at least 90 % was asked for; "
        "more runs may show otherwise",
        "missed: p95 of cycle is 1.25 s, at most 0.900 s was asked for",
    ]


def test_that_every_bound_is_met_is_told_so_far_or_at_the_end():
    met = [judged("share", 0.95, is_met=True)] * 2
    assert told(judgements=met)[1:-1] == ["every bound is met (2)"]
    so_far = told(judgements=met, left=1, runs=Runs(10, 9, 0, 0))
    assert so_far == [
        "grip: 9 of 10 runs ended",
        "every bound is met so far (2)",
        "1 run left; what has ended is kept",
        "  go on      executive campaign 'out/my runs' --resume",
        "  folder     out/my runs",
    ]


def test_the_first_failure_is_told_with_the_command_that_repeats_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    results = [result(1, "success"), result(2, "fault", mission="api: 1"), result(3, "failure")]
    assert told(results=results)[1:-1] == [
        "first failure: run 2 (seed 7, stones=scans) fault in 1 min 03 s: fell over",
        "  repeat it  executive run 'out/my runs/repeat/2.yaml' --seed 7",
    ]
    other_work = [result(4, "", Status.TIMED_OUT, work="bench")]
    assert told(results=other_work)[1:-1] == [
        "first failure: run 4 (seed 7, stones=scans) timed out in 1 min 03 s: fell over"
    ]
