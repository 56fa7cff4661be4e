"""Write the tables of the pages from the figures of campaigns, and copy their pictures.

    python docs/campaign_tables.py              write all blocks anew from docs/campaigns/results
    python docs/campaign_tables.py --take DIR   copy a campaign's figures and pictures first
    python docs/campaign_tables.py --check      write nothing; exit 1 if a page is not up to date

A page holds blocks; what is between the two comments is written by this script:

    <!-- campaign: NAME table=shares metrics=success,placed -->
    <!-- end -->

NAME is that of the campaign in `docs/campaigns/NAME.yaml`; `table` is one of `figures` (shares and
values), `shares`, `values`, `differences`, `bounds`, or several with commas; `metrics` chooses and
orders metrics; `chart=share-success` shows a picture of the campaign's folder. Above them is the
command that made them, with its seeds and its number of runs.
`tests/docs/test_campaign_tables.py` fails when a page is not up to date.
"""

import argparse
import json
import re
import shlex
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from executive.campaign.figures.figures import Estimate
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.sections.differences import compared, difference, interval_of
from executive.campaign.reporting.summary import Summary, read_summary
from executive.campaign.reporting.wording import amount, figure, interval, number_ranges, percent
from executive.errors import DataError

DOCS = Path(__file__).parent
BLOCK = re.compile(r"<!-- campaign: ([a-z]\w*) ([^>]*?) ?-->\n.*?<!-- end -->", re.S)
OPTIONS = ("table", "metrics", "chart")
# Options of the command that say where and how it ran, and whether a value follows.
PLACES = {
    "--out": True,
    "--jobs": True,
    "--scheduler": True,
    "--again": True,
    "--resume": False,
    "--quiet": False,
    "--json": False,
}
Row = Sequence[str]


def table(heads: Row, rows: Sequence[Row]) -> str:
    """Return a table in Markdown."""
    escaped = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    lines = [heads, ["---"] * len(heads), *escaped]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def estimates(summary: Summary, metrics: Sequence[str]) -> Iterator[tuple[str, str, Estimate]]:
    """Yield title, cell and estimate of the chosen metrics."""
    cells = Cells(summary.campaign.factors)
    for name in metrics:
        for one in summary.figures.estimates:
            if one.metric == name and one.of:
                yield summary.campaign.metrics[name].title, cells.name(one.levels), one


def shares(summary: Summary, metrics: Sequence[str]) -> str:
    """Return shares: a row a metric and cell."""
    rows = [
        (title, cell, percent(share), interval(within, is_share=True), f"{one.hits} of {one.of}")
        for title, cell, one in estimates(summary, metrics)
        if "share" in one.statistics
        for share, within in [one.statistics["share"]]
    ]
    heads = ("metric", Cells(summary.campaign.factors).title, "share", "95 % interval", "hits")
    return _without_single_cell(heads, rows)


def values(summary: Summary, metrics: Sequence[str]) -> str:
    """Return medians and tails: a row a metric and cell."""
    rows = []
    for title, cell, one in estimates(summary, metrics):
        unit = summary.campaign.metrics[one.metric].unit
        if "median" in one.statistics:
            median, within = one.statistics["median"]
            tails = [amount(one.statistics[name][0], unit) for name in ("p95", "max")]
            told = (amount(median, unit), interval(within, unit))
            rows.append((title, cell, *told, *tails, str(one.of)))
    title = Cells(summary.campaign.factors).title
    heads = ("metric", title, "median", "95 % interval", "95th percentile", "largest", "values")
    return _without_single_cell(heads, rows)


def figures(summary: Summary, metrics: Sequence[str]) -> str:
    """Return shares, then values; what there is none of is left out."""
    told = [write(summary, metrics) for write in (shares, values)]
    return "\n\n".join(one for one in told if one)


def differences(summary: Summary, metrics: Sequence[str]) -> str:
    """Return paired differences with their verdicts."""
    cells, words = Cells(summary.campaign.factors), summary.campaign.metrics
    rows = [
        (
            words[one.metric].title,
            f"{compared(one, cells)} against {one.baseline}",
            difference(one, words[one.metric]),
            interval_of(one, words[one.metric]),
            f"{one.better} better, {one.worse} worse of {one.pairs}",
            one.words,
        )
        for name in metrics
        for one in summary.figures.differences
        if one.metric == name
    ]
    heads = ("metric", "compared", "difference", "95 % interval", "pairs", "verdict")
    return table(heads, rows) if rows else ""


def bounds(summary: Summary, metrics: Sequence[str]) -> str:
    """Return bounds and what was measured; what misses its bound is bold."""
    cells = Cells(summary.campaign.factors)
    rows = []
    for one in summary.figures.judgements:
        if one.bound.metric not in metrics:
            continue
        words, is_share = summary.campaign.metrics[one.bound.metric], one.bound.statistic == "share"
        measured = figure(one.value, words.unit, is_share)
        told = f"{measured} ({interval(one.interval, words.unit, is_share)})"
        sign = "≥" if one.bound.is_least else "≤"
        limit = f"{sign} {figure(one.bound.limit, words.unit, is_share)}"
        title = words.title if is_share else f"{words.title}, {one.bound.statistic}"
        rows.append((title, cells.name(one.levels), limit, told if one.is_met else f"**{told}**"))
    heads = ("metric", cells.title, "bound", "measured (95 % interval)")
    return _without_single_cell(heads, rows)


TABLES: dict[str, Callable[[Summary, Sequence[str]], str]] = {
    "figures": figures,
    "shares": shares,
    "values": values,
    "differences": differences,
    "bounds": bounds,
}


def _without_single_cell(heads: Row, rows: Sequence[Row]) -> str:
    """Return the table without the column of cells if there is one cell."""
    if not rows:
        return ""
    if len({row[1] for row in rows}) == 1:
        heads, rows = (heads[0], *heads[2:]), [(row[0], *row[2:]) for row in rows]
    return table(heads, rows)


def provenance(summary: Summary) -> str:
    """Return the command, and what the figures were made of."""
    head = summary.campaign
    runs, made_with = head.runs, ", ".join(head.versions)
    told = f"{runs.asked:,} runs on seeds {number_ranges(head.seeds)}"
    if runs.without_answer:
        told += f", {runs.without_answer:,} without an answer"
    if runs.missing:
        told += f", **{runs.missing:,} not ended**"
    return f"```sh\n{head.command}\n```\n\n{told}; executive {made_with}."


def block(name: str, options: str, page: Path, docs: Path = DOCS) -> str:
    """Return a block with its comments.

    Raises:
        DataError: If the campaign has no figures, or an option is unknown.
    """
    where = f"{page.name}: campaign {name}"
    given = dict(option.partition("=")[::2] for option in options.split())
    if set(given) - set(OPTIONS) or not {"table", "chart"} & set(given):
        raise DataError(f"{where}: expected table= or chart=, and metrics=; got '{options}'")
    summary = read_summary(docs / "campaigns" / "results" / f"{name}.json")
    metrics = given["metrics"].split(",") if "metrics" in given else list(summary.campaign.metrics)
    unknown = [metric for metric in metrics if metric not in summary.campaign.metrics]
    if unknown:
        raise DataError(f"{where}: its figures have no metric {', '.join(unknown)}")
    wanted = given["table"].split(",") if "table" in given else []
    if wrong := set(wanted) - set(TABLES):
        raise DataError(f"{where}: table={wrong.pop()} is not one of {', '.join(TABLES)}")
    parts = [provenance(summary), *(TABLES[one](summary, metrics) for one in wanted)]
    if "chart" in given:
        depth = "../" * (len(page.relative_to(docs).parts) - 1)
        parts.append(f"![{name}: {given['chart']}]({depth}images/{picture(name, given['chart'])})")
    if not all(parts):
        raise DataError(f"{where}: there is nothing to show for '{options}'")
    text = "\n\n".join(parts)
    return f"<!-- campaign: {name} {options} -->\n{text}\n<!-- end -->"


def picture(name: str, chart: str) -> str:
    """Return the name of a copied picture."""
    return f"{name}-{chart}.png"


def written(page: Path, docs: Path = DOCS) -> str:
    """Return a page with its blocks as they should be."""
    text = page.read_text(encoding="utf-8")
    return BLOCK.sub(lambda found: block(found[1], found[2], page, docs), text)


def stale(docs: Path = DOCS) -> list[str]:
    """Return what is not up to date: pages, and pictures that are missing."""
    found = [
        f"{page.relative_to(docs)} is not up to date: run `python docs/campaign_tables.py`"
        for page in sorted(docs.rglob("*.md"))
        if written(page, docs) != page.read_text(encoding="utf-8")
    ]
    lacking = (one for one in wanted_pictures(docs) if not (docs / "images" / one).is_file())
    return found + [f"images/{one} is missing: take it from the campaign" for one in lacking]


def wanted_pictures(docs: Path = DOCS) -> list[str]:
    """Return the pictures of campaigns that pages show."""
    texts = (page.read_text(encoding="utf-8") for page in sorted(docs.rglob("*.md")))
    blocks = (found for text in texts for found in BLOCK.finditer(text))
    charts = ((found[1], re.search(r"chart=(\S+)", found[2])) for found in blocks)
    return [picture(name, chart[1]) for name, chart in charts if chart]


def anywhere(command: str) -> str:
    """Return a command without where its runs happened, which changes no figure."""
    words, kept = iter(shlex.split(command)), []
    for word in words:
        option, is_joined, _ = word.partition("=")
        if option in PLACES:
            if PLACES[option] and not is_joined:
                next(words, None)
        else:
            kept.append(word)
    return shlex.join(kept)


def take(folder: Path, docs: Path = DOCS) -> None:
    """Copy the figures of a finished campaign, and those of its pictures that pages show."""
    summary = read_summary(folder / "figures.json")
    name = summary.campaign.name
    results = docs / "campaigns" / "results"
    results.mkdir(parents=True, exist_ok=True)
    document = json.loads((folder / "figures.json").read_text(encoding="utf-8"))
    document["campaign"]["command"] = anywhere(summary.campaign.command)
    text = json.dumps(document, indent=1, ensure_ascii=False) + "\n"
    (results / f"{name}.json").write_text(text, encoding="utf-8")
    for one in (folder / "charts").glob("*.png"):
        if picture(name, one.stem) in wanted_pictures(docs):
            shutil.copyfile(one, docs / "images" / picture(name, one.stem))


def main() -> int:
    """Write or check the pages; return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if stale")
    parser.add_argument("--take", type=Path, metavar="DIR", help="folder of a finished campaign")
    options = parser.parse_args()
    try:
        if options.take:
            take(options.take)
        if not options.check:
            for page in sorted(DOCS.rglob("*.md")):
                page.write_text(written(page), encoding="utf-8")
        problems = stale()
    except DataError as error:
        problems = [str(error)]
    for problem in problems:
        print(problem, file=sys.stderr)
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
