"""A comparison of two runs as text for a person, and as plain values for programs."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from executive.campaign.reporting.journal_line import journal_line
from executive.campaign.reporting.runs.read_run import words_of
from executive.campaign.reporting.runs.run_comparison import RunComparison
from executive.campaign.reporting.runs.run_report import measured_words
from executive.campaign.reporting.wording import NOTHING, plural, shortened
from executive.journal import Entry

_MOST_SETTINGS = 40
_WIDTH = 44  # of a value


def comparison_answer(comparison: RunComparison) -> dict[str, Any]:
    """Return the comparison as JSON holds it; a pair of values is a list of two."""
    first = comparison.first_difference
    return {
        "runs": [str(run.folder) for run in comparison.runs],
        "damages": [list(run.damages) for run in comparison.runs],
        "settings": dict(comparison.settings),
        "endings": dict(comparison.endings),
        "counts": dict(comparison.counts),
        "measurements": dict(comparison.measurements),
        "timings_ms": dict(comparison.timings),
        "picks": [list(two) for two in comparison.picks],
        "first_difference": first
        and {"entry": first.number, "entries": [_plain(entry) for entry in first.entries]},
    }


def comparison_text(comparison: RunComparison) -> str:
    """Return the comparison for a person: both runs in columns, what is equal left out."""
    settings = list(comparison.settings.items())
    sections = [
        _columns("", [("", str(comparison.runs[0].folder), str(comparison.runs[1].folder))]),
        _columns("ending", _rows(comparison.endings.items())),
        _columns(
            f"settings: {plural(len(settings), 'difference')}", _rows(settings[:_MOST_SETTINGS])
        )
        or "settings: equal",
        *([f"  {len(settings) - _MOST_SETTINGS} more"] if len(settings) > _MOST_SETTINGS else []),
        _columns("metrics", list(_measured(comparison))),
        _columns("counts that differ", _rows(comparison.counts.items())),
        _columns(
            "picks", [(str(number), a, b) for number, (a, b) in enumerate(comparison.picks, 1)]
        ),
        _columns("median wall time [ms]", _rows(comparison.timings.items())),
        _journals(comparison),
    ]
    return "\n\n".join(section for section in sections if section)


def _rows(values: Iterable[tuple[str, tuple[Any, Any]]]) -> list[tuple[str, str, str]]:
    return [(name, _shown(a), _shown(b)) for name, (a, b) in values]


def _shown(value: Any) -> str:
    return NOTHING if value is None or value == "" else str(value)


def _measured(comparison: RunComparison) -> Iterator[tuple[str, str, str]]:
    for name, two in comparison.measurements.items():
        told = [NOTHING if one is None else measured_words(name, one) for one in two]
        yield words_of(name).title, told[0], told[1]


def _columns(title: str, rows: Sequence[tuple[str, str, str]]) -> str:
    """Return rows in columns that are as wide as their content, below a title."""
    if not rows:
        return ""
    cut = [(name, shortened(a, _WIDTH), shortened(b, _WIDTH)) for name, a, b in rows]
    first = max(24, *(len(name) for name, _, _ in cut))
    second = max(20, *(len(a) for _, a, _ in cut))
    lines = [f"  {name:{first}}  {a:{second}}  {b}".rstrip() for name, a, b in cut]
    return "\n".join([title, *lines] if title else lines)


def _journals(comparison: RunComparison) -> str:
    first = comparison.first_difference
    if first is None:
        return f"journals: equal, {len(comparison.runs[0].entries)} entries"
    lines = [f"journals: the first difference is entry {first.number}"]
    for run, entry in zip(comparison.runs, first.entries, strict=True):
        told = "the journal has ended before" if entry is None else _line(entry)
        lines += [f"  {run.folder}", f"    {told}"]
    return "\n".join(lines)


def _line(entry: Entry) -> str:
    return journal_line(entry.time_s, entry.kind, entry.node, entry.event.payload())


def _plain(entry: Entry | None) -> dict[str, Any] | None:
    if entry is None:
        return None
    return {
        "tick": entry.tick,
        "time_s": entry.time_s,
        "kind": entry.kind,
        "node": entry.node,
        "payload": entry.event.payload(),
    }
