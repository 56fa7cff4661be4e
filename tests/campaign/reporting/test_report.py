"""The report of a campaign: what it writes, in which order, and that nothing in it is active."""

import csv
import dataclasses
import html
import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest
from pyarrow import parquet
from typer.testing import CliRunner

from executive.campaign.figures.calculation import figures_of
from executive.campaign.figures.row import row_of
from executive.campaign.reporting.report import report_campaign
from executive.campaign.reporting.summary import read_summary
from executive.campaign.trial import Outcome, Status
from executive.commands.main import app

ANSWER = {
    "report": {"outcome": "failure", "reason": "no stone was placed"},
    "measurements": {"success": {"hits": 0, "of": 1}, "placement_error": {"values": []}},
}


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
    fixed = ("number", "seed", "status", "outcome", "reason", "wall_s", "cpu_s", "tries", "worker")
    assert {*fixed, "peak_memory_bytes"} <= columns.keys()
    assert {*fixed, "peak_memory_bytes"} <= rows[0].keys()
    assert not list(folder.glob("*.partial"))
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


def body_of(folder: Path) -> str:
    page = (folder / "report.html").read_text(encoding="utf-8")
    return page.split("<main>")[1].split("</main>")[0]


def test_a_campaign_without_a_finished_run_has_a_report(
    made_up: ModuleType, tmp_path: Path
) -> None:
    campaign = made_up.campaign()
    made_up.write_ledger(tmp_path, campaign, ())
    report_campaign(tmp_path, campaign)
    body = body_of(tmp_path)
    assert "40 runs of the campaign have not ended" in body
    assert "data-chart" not in body
    assert re.search(r"\d+ of \d+ bounds missed so far\.", body)


def test_runs_without_an_answer_come_first_and_count_as_failed(
    made_up: ModuleType, tmp_path: Path
) -> None:
    campaign = made_up.campaign(range(1, 6), {})
    made_up.write_ledger(
        tmp_path,
        campaign,
        [
            Outcome(n, Status.CRASHED if n == 3 else Status.DONE, "signal 11" * (n == 3), ANSWER)
            for n in range(5)
        ],
    )
    run = tmp_path / "runs" / "3-1"
    run.mkdir(parents=True)
    (run / "output.txt").write_text("Fatal Python error: Segmentation fault\n", encoding="utf-8")
    report_campaign(tmp_path, campaign)
    body = body_of(tmp_path)
    assert "1 run without an answer and 4 missions without success, of 5 runs." in body
    assert re.findall(r"<h3>(Run \d+: \w+)</h3>", body)[0] == "Run 3: crashed"
    assert "Fatal Python error: Segmentation fault" in body
    assert "0 of 5" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_the_command_of_a_failed_run_names_its_own_mission_and_seed(
    made_up: ModuleType, tmp_path: Path
) -> None:
    campaign = made_up.campaign(range(7, 9), {})
    first, second = campaign.trials
    asked = replace(second, arguments={**second.arguments, "answers": ["slowly"]})
    campaign = replace(campaign, trials=(first, asked))
    found = [Outcome(n, Status.DONE, "", ANSWER) for n in range(2)]
    made_up.write_ledger(tmp_path, campaign, found)
    (tmp_path / "runs" / "0-1").mkdir(parents=True)
    (tmp_path / "runs" / "0-1" / "mission.yaml").write_text("mission: kept\n", encoding="utf-8")
    report_campaign(tmp_path, campaign)
    commands = re.findall(r"<pre>(executive run .*?)</pre>", body_of(tmp_path))
    assert commands == [
        f"executive run {tmp_path}/runs/0-1/mission.yaml --seed 7",
        f"executive run {tmp_path}/repeat/1.yaml --seed 8 --answer slowly",
    ]
    assert (tmp_path / "repeat" / "1.yaml").read_text(encoding="utf-8") == made_up.MISSION


def test_a_comparison_that_measured_nothing_has_words_and_no_chart(
    made_up: ModuleType, tmp_path: Path
) -> None:
    campaign = made_up.campaign(range(1, 4))
    comparison = dataclasses.replace(campaign.comparisons[0], metrics=("placement_error",))
    campaign = dataclasses.replace(campaign, comparisons=(comparison,))
    made_up.write_ledger(
        tmp_path,
        campaign,
        (Outcome(one.number, Status.DONE, "", ANSWER) for one in campaign.trials),
    )
    report = report_campaign(tmp_path, campaign)
    (told,) = report.summary.figures.differences
    assert told.pairs == 0
    assert told.words in html.unescape(body_of(tmp_path))
    assert not list((tmp_path / "charts").glob("difference-*.png"))


def test_long_lists_are_cut_and_say_by_how_much(made_up: ModuleType, tmp_path: Path) -> None:
    campaign = made_up.campaign([1, 2, 3], {"count": tuple(str(n) for n in range(75))})
    made_up.write_ledger(
        tmp_path,
        campaign,
        (Outcome(one.number, Status.DONE, "", ANSWER) for one in campaign.trials),
    )
    report_campaign(tmp_path, campaign)
    body = body_of(tmp_path)
    assert body.count('<div class="run">') == 20
    assert "25 further runs that failed: see results.csv." in body
    assert "15 further rows: see the tables and results.csv." in body


def test_the_verb_makes_it_anew_from_the_folder_alone(made_up: ModuleType, tmp_path: Path) -> None:
    folder = tmp_path / "campaign"
    campaign = made_up.waiting(folder, "1:12")
    made_up.write_ledger(folder, campaign, made_up.outcomes(campaign))
    done = CliRunner().invoke(app, ["report", str(folder), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout) == json.loads((folder / "figures.json").read_text())
    assert json.loads(done.stdout)["campaign"]["runs"]["asked"] == 12
    assert "<h1>waits</h1>" in body_of(folder)


def test_ten_thousand_runs_take_less_than_20_s_and_1_gb(
    made_up: ModuleType, tmp_path: Path
) -> None:
    campaign = made_up.campaign(range(5000))
    made_up.write_ledger(tmp_path, campaign, made_up.outcomes(campaign), is_durable=False)
    program = (
        "import importlib.util, re, time\n"
        "from pathlib import Path\n"
        "from executive.campaign.reporting.report import report_campaign\n"
        f"spec = importlib.util.spec_from_file_location('made_up', {made_up.__file__!r})\n"
        "made_up = importlib.util.module_from_spec(spec)\n"
        "spec.loader.exec_module(made_up)\n"
        "campaign = made_up.campaign(range(5000))\n"
        f"report_campaign(Path({str(tmp_path)!r}), campaign)\n"
        # Not `ru_maxrss`: after a fork and an exec it still holds the size of the parent.
        "peak_kb = re.search(r'VmHWM:\\s*(\\d+)', Path('/proc/self/status').read_text())[1]\n"
        "print(time.process_time(), int(peak_kb) / 2**20)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=300, check=True
    )
    cpu_s, memory_gb = map(float, done.stdout.split())
    # Processor time, because other programs may share the computer; nothing in it waits.
    assert cpu_s < 20.0
    assert memory_gb < 1.0
    assert (tmp_path / "report.html").stat().st_size < 3e6
