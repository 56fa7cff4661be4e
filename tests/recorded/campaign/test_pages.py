"""The pages of made-up campaigns: what they say, and the specifications of their charts."""

import re
import runpy
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from executive.campaign.reporting.campaign_page import campaign_page
from executive.campaign.reporting.report import summarise_campaign
from executive.campaign.trial import Outcome, Status

CASES = Path(__file__).parents[2] / "campaign" / "reporting" / "made_up.py"
MADE_UP = SimpleNamespace(**runpy.run_path(str(CASES)))
PHASES = ("mapping_time", "plan_time")
MANY = {"count": tuple(map(str, range(9)))}
TWO = {"estimation": ("dual_graph", "error_state_ekf"), "grasping": ("a", "b")}
JOURNAL = """\
{"tick": 3, "time_s": 0.3, "node": "main/0", "kind": "node_ended", "status": "failure"}
{"tick": 4, "time_s": 0.4, "node": "", "kind": "fault", "plugin": "motion", "reason": "no way"}
"""


def with_phases(found: Iterator[Outcome]) -> Iterator[Outcome]:
    """Yield outcomes that measure the durations of two phases, too."""
    chance = np.random.default_rng(5)
    for one in found:
        if one.status is Status.DONE:
            times = {name: {"values": chance.gamma(4.0, 9.0, size=3).tolist()} for name in PHASES}
            measured = {**one.answer["measurements"], **times}
            one = replace(one, answer={**one.answer, "measurements": measured})
        yield one


def page_of(folder: Path, campaign, found) -> tuple[str, list]:
    """Return the words of a campaign's page, and its charts."""
    MADE_UP.write_ledger(folder, campaign, found, is_durable=False)
    for run in ("1-1", "2-1"):
        (folder / "runs" / run).mkdir(parents=True)
        (folder / "runs" / run / "journal.jsonl").write_text(JOURNAL, encoding="utf-8")
    report = summarise_campaign(folder, campaign)
    page = campaign_page(folder, report.summary, report.results)
    page.write(folder / "page.html")
    body = (folder / "page.html").read_text(encoding="utf-8").split("</main>")[0]
    words = re.sub(r"<script.*?</script>", "<script/>", body.split("<main>")[1], flags=re.S)
    return words.replace(str(folder), "FOLDER"), [
        (one.name, one.title, one.spec) for one in page.pictures
    ]


@pytest.mark.parametrize(
    ("seeds", "factors", "share"),
    [
        (range(1, 13), None, 0.85),
        (range(1, 13), {}, 0.5),
        (range(3, 9), TWO, 1.0),
        (range(1, 4), MANY, 0.0),
    ],
    ids=["two cells", "one cell", "four cells, all good", "many cells, all bad"],
)
def test_pages(recorded, tmp_path, monkeypatch, seeds, factors, share) -> None:
    monkeypatch.setattr("executive.campaign.reporting.page.page._vega", lambda: "")
    campaign = MADE_UP.campaign(seeds, factors)
    metrics = (*campaign.metrics, *PHASES, "ghosts")
    compared = [replace(one, metrics=metrics) for one in campaign.comparisons]
    campaign = replace(campaign, metrics=metrics, comparisons=tuple(compared))
    words, charts = page_of(tmp_path, campaign, with_phases(MADE_UP.outcomes(campaign, share)))
    recorded(words)
    recorded(charts)


def test_a_campaign_of_which_nothing_has_ended(recorded, tmp_path) -> None:
    words, charts = page_of(tmp_path, MADE_UP.campaign(range(1, 4)), ())
    assert not charts
    recorded(words)
