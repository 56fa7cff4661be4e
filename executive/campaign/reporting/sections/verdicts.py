"""The verdicts of bounds."""

from executive.campaign.figures.figures import Judgement
from executive.campaign.reporting.cells import Cells
from executive.campaign.reporting.page.markup import Markup, paragraph, table, tag
from executive.campaign.reporting.summary import Summary
from executive.campaign.reporting.wording import figure, interval, plural

_MOST_OPEN = 20  # bounds; of more, those that are met are folded


def verdicts(summary: Summary) -> list[Markup]:
    """Return the table of bounds: what was asked, what was measured, missed ones first."""
    judgements = summary.figures.judgements
    if not judgements:
        return [paragraph("This campaign sets no bounds.", class_="note")]
    missed = sum(not one.is_met for one in judgements)
    so_far = " so far" if summary.campaign.runs.missing else ""
    told = (
        tag("span", f"{missed} of {plural(len(judgements), 'bound')} missed{so_far}.", class_="bad")
        if missed
        else tag("span", f"All {plural(len(judgements), 'bound')} met{so_far}.", class_="good")
    )
    cells = Cells(summary.campaign.factors)
    rows = [_row(one, summary, cells) for one in sorted(judgements, key=lambda one: one.is_met)]
    heads = ("verdict", "metric", cells.title, "bound", "measured", "95 % interval")
    first = rows if len(rows) <= _MOST_OPEN else rows[:missed]
    parts = [paragraph(told), table(heads, first) if first else Markup()]
    if len(first) < len(rows):
        title = tag("summary", f"{plural(len(rows) - len(first), 'bound')} met")
        parts.append(tag("details", title, table(heads, rows[len(first) :])))
    unsure = (
        "A verdict is sure if the whole interval is on its side of the bound; the others may "
        "change with more seeds."
    )
    return [*parts, paragraph(unsure, class_="note")]


def _row(judgement: Judgement, summary: Summary, cells: Cells) -> tuple[str, ...]:
    bound = judgement.bound
    words = summary.campaign.metrics[bound.metric]
    is_share = bound.statistic == "share"
    told = ("met" if judgement.is_met else "missed") + ("" if judgement.is_sure else ", not sure")
    kind = "bad" if not judgement.is_met else "good" if judgement.is_sure else "unsure"
    limit = figure(bound.limit, words.unit, is_share)
    return (
        tag("span", told, class_=f"{kind} verdict"),
        words.title if is_share else f"{words.title}, {bound.statistic}",
        cells.name(judgement.levels),
        f"{'≥' if bound.is_least else '≤'} {limit}",
        figure(judgement.value, words.unit, is_share),
        interval(judgement.interval, words.unit, is_share),
    )
