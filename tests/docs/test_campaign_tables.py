"""The tables of pages that campaigns have measured are those of the committed figures."""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from executive.campaign.description.campaign import Campaign
from executive.campaign.reporting.report import report_campaign
from executive.errors import DataError

ROOT = Path(__file__).parents[2]
BLOCK = "# A page\n\n<!-- campaign: two_estimators {} -->\n<!-- end -->\n\nMore.\n"


def module(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


@pytest.fixture(scope="module")
def tables() -> ModuleType:
    return module(ROOT / "docs" / "campaign_tables.py")


@pytest.fixture(scope="module")
def made_up() -> ModuleType:
    return module(ROOT / "tests" / "campaign" / "reporting" / "made_up.py")


@pytest.fixture(scope="module")
def finished(made_up: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a finished campaign."""
    folder = tmp_path_factory.mktemp("finished")
    campaign: Campaign = made_up.campaign()
    made_up.write_ledger(folder, campaign, made_up.outcomes(campaign))
    report_campaign(folder, campaign)
    return folder


@pytest.fixture
def docs(finished: Path, tmp_path: Path) -> Path:
    """Return a folder of pages with the figures of a campaign."""
    results = tmp_path / "campaigns" / "results"
    results.mkdir(parents=True)
    shutil.copyfile(finished / "figures.json", results / "two_estimators.json")
    (tmp_path / "images").mkdir()
    return tmp_path


def test_every_page_says_what_the_figures_say(tables: ModuleType) -> None:
    assert tables.stale() == []


def test_check_is_a_command() -> None:
    script = ROOT / "docs" / "campaign_tables.py"
    done = subprocess.run(
        [sys.executable, script, "--check"], capture_output=True, text=True, timeout=120
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("kind", ["figures", "shares", "values", "differences", "bounds"])
def test_a_block_holds_the_command_and_the_table(tables: ModuleType, docs: Path, kind: str) -> None:
    page = docs / "page.md"
    page.write_text(BLOCK.format(f"table={kind}"), encoding="utf-8")
    text = tables.written(page, docs)
    assert "```sh\nexecutive campaign two_estimators.yaml --seeds 1:20\n```" in text
    assert "40 runs on seeds 1–20" in text
    assert "error_state_ekf" in text
    assert text.endswith("<!-- end -->\n\nMore.\n")
    page.write_text(text, encoding="utf-8")
    assert tables.written(page, docs) == text
    assert tables.stale(docs) == []


def test_a_changed_figure_makes_the_page_stale(tables: ModuleType, docs: Path) -> None:
    page = docs / "page.md"
    page.write_text(BLOCK.format("table=shares metrics=success"), encoding="utf-8")
    page.write_text(tables.written(page, docs), encoding="utf-8")
    results = docs / "campaigns" / "results" / "two_estimators.json"
    changed = results.read_text().replace('"hits": 16', '"hits": 11')
    assert changed != results.read_text()
    results.write_text(changed)
    (told,) = tables.stale(docs)
    assert told.startswith("page.md is not up to date")


def test_a_picture_is_taken_and_shown(tables: ModuleType, docs: Path, finished: Path) -> None:
    (docs / "how-to").mkdir()
    page = docs / "how-to" / "page.md"
    page.write_text(BLOCK.format("chart=share-success"), encoding="utf-8")
    page.write_text(tables.written(page, docs), encoding="utf-8")
    assert "](../images/two_estimators-share-success.png)" in page.read_text()
    (told,) = tables.stale(docs)
    assert "two_estimators-share-success.png is missing" in told
    tables.take(finished, docs)
    assert tables.stale(docs) == []


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ("metrics=success", "expected table= or chart="),
        ("table=pie", "table=pie is not one of"),
        ("table=shares metrics=sucess", "no metric sucess"),
        ("table=differences metrics=placement_error", "nothing to show"),
    ],
)
def test_a_wrong_block_is_refused(tables: ModuleType, docs: Path, options: str, told: str) -> None:
    page = docs / "page.md"
    page.write_text(BLOCK.format(options), encoding="utf-8")
    with pytest.raises(DataError, match=told):
        tables.written(page, docs)
    page.write_text(BLOCK.format("table=shares").replace("two_", "no_"), encoding="utf-8")
    with pytest.raises(DataError, match=r"no_estimators\.json"):
        tables.written(page, docs)


def test_several_tables_have_one_command(tables: ModuleType, docs: Path) -> None:
    page = docs / "page.md"
    page.write_text(BLOCK.format("table=shares,values"), encoding="utf-8")
    text = tables.written(page, docs)
    assert text.count("```sh") == 1
    assert text.count("\n| --- |") == 2


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("executive campaign a.yaml --seeds 1:5 --out /x/y --jobs 2", "a.yaml --seeds 1:5"),
        ("executive campaign a.yaml --resume --out=/x --set b.c=1", "a.yaml --set b.c=1"),
        ("executive campaign a.yaml --scheduler tcp://h:1 --quiet", "a.yaml"),
    ],
)
def test_a_page_does_not_say_where_it_ran(tables: ModuleType, given: str, kept: str) -> None:
    assert tables.anywhere(given) == f"executive campaign {kept}"
