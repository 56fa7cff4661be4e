"""The report of a campaign: what it writes, in which order, and that nothing in it is active."""

import csv
import dataclasses
import html
import re
from pathlib import Path
from types import ModuleType

import pytest
from pyarrow import parquet

from executive.campaign.figures.calculation import figures_of
from executive.campaign.figures.row import row_of
from executive.campaign.reporting.report import report_campaign
from executive.campaign.reporting.summary import read_summary


@pytest.fixture(scope="module")
def folder(made_up: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    campaign = made_up.campaign()
    path = tmp_path_factory.mktemp("report")
    made_up.write_ledger(path, campaign, made_up.outcomes(campaign))
    report_campaign(path, campaign)
    return path


def test_it_writes_page_pictures_tables_and_figures(folder: Path) -> None:
    assert {one.name for one in folder.iterdir()} >= {
        "report.html",
        "charts",
        "results.csv",
        "results.parquet",
        "figures.json",
    }
    pictures = list((folder / "charts").glob("*.png"))
    assert len(pictures) >= 4
    assert all(one.read_bytes().startswith(b"\x89PNG") for one in pictures)
    assert not list(folder.rglob("*.partial"))


def test_the_sections_are_in_the_order_in_which_they_are_needed(folder: Path) -> None:
    page = (folder / "report.html").read_text(encoding="utf-8").split("</main>")[0]
    assert re.findall(r"<h2[^>]*>(.*?)</h2>", page) == [
        "Bounds",
        "Failures",
        "Shares",
        "Distributions",
        "Phases",
        "Paired differences",
        "All figures",
        "Resources",
        "Not measured",
    ]


def test_the_page_loads_nothing(folder: Path) -> None:
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "default-src 'none'" in html.unescape(page)
    document = re.sub(r"<script>.*?</script>", "", page, flags=re.S)  # Vega names what it can draw
    assert not re.findall(r"<(?:link|img|iframe|object|script[^>]* src)\b|@import|url\(", document)
    assert "vegaEmbed" in page


def test_the_figures_are_read_back_as_they_were(made_up: ModuleType, folder: Path) -> None:
    campaign = made_up.campaign()
    summary = read_summary(folder / "figures.json")
    rows = [row_of(campaign.trials[one.number], one) for one in made_up.outcomes(campaign)]
    figures = figures_of(rows, campaign.metrics, campaign.bounds, campaign.comparisons)
    assert repr(summary.figures) == repr(figures)  # NaN is not equal to itself
    assert summary.campaign.command == campaign.command
    assert summary.campaign.runs.asked == len(campaign.trials)


def test_the_tables_hold_a_row_a_run(made_up: ModuleType, folder: Path) -> None:
    campaign = made_up.campaign()
    found = list(made_up.outcomes(campaign))
    with (folder / "results.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    columns = parquet.read_table(folder / "results.parquet").to_pydict()
    assert len(rows) == len(found) == len(columns["number"])
    for row, outcome in zip(rows, found, strict=True):
        assert int(row["number"]) == outcome.number
        assert row["status"] == outcome.status.value
        assert row["estimation"] == campaign.trials[outcome.number].levels["estimation"]
    first = found[0].answer["measurements"]
    assert columns["success.hits"][0] == first["success"]["hits"]
    assert columns["placement_error"][0] == first["placement_error"]["values"]
    assert columns["placement_error.max"][0] == max(first["placement_error"]["values"])


def test_what_runs_say_is_text_never_markup(made_up: ModuleType, tmp_path: Path) -> None:
    nasty = "</script><script>alert('x')</script><img src=x onerror=alert(1)> & \"'"
    campaign = dataclasses.replace(
        made_up.campaign(range(1, 4), {"plugin": (nasty, "plain")}),
        name=nasty,
        description=nasty,
        command=nasty,
    )
    made_up.write_ledger(
        tmp_path,
        campaign,
        (
            dataclasses.replace(one, reason=nasty, worker=nasty)
            for one in made_up.outcomes(campaign, share=0.1)
        ),
    )
    journal = tmp_path / "runs" / "0-1"
    journal.mkdir(parents=True)
    (journal / "journal.jsonl").write_text(nasty + "\n", encoding="utf-8")
    report_campaign(tmp_path, campaign)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    body = page.split("<main>")[1].split("</main>")[0]
    assert "<script>" not in body
    assert "<img" not in body
    assert "&lt;script&gt;" in body
    scripts = re.findall(r"<script[^>]*data-chart[^>]*>(.*?)</script>", body, re.S)
    assert len(scripts) == body.count("</script>") > 0
    assert not any("<" in one for one in scripts)
