"""The course of a run in time: its leaves, and the attempts at each stone."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from executive.campaign.reporting.charts.spec import (
    ACCENT,
    BAD,
    GOOD,
    SOFT,
    TAIL,
    Spec,
    row_name,
    rows,
    specification,
)
from executive.campaign.reporting.journal_line import leaf_name
from executive.events.node import NodeEnded, NodeStarted
from executive.interfaces.report import PickReport
from executive.journal import Entry
from executive.mission.picks import NOT_LIFTED, SHIFTED

_UNFINISHED = "unfinished"
_COLOURS = {
    "success": GOOD,
    "placed": GOOD,
    "failure": BAD,
    "slip": BAD,
    "drop": BAD,
    "empty": TAIL,
    NOT_LIFTED: TAIL,
    SHIFTED: TAIL,
    "halted": SOFT,
    _UNFINISHED: SOFT,
}


@dataclass(frozen=True, slots=True)
class Bar:
    """One bar of a timeline.

    Attributes:
        name: Its row.
        from_s: Its begin on the mission's clock [s].
        to_s: Its end [s].
        result: How it ended, which gives its colour.
        words: What is shown when it is pointed at.
    """

    name: str
    from_s: float
    to_s: float
    result: str
    words: str


def leaf_bars(entries: Sequence[Entry]) -> list[Bar]:
    """Return a bar each time that a leaf was active, from the journal."""
    inner = {parent for node in {entry.node for entry in entries} for parent in _parents(node)}
    begun: dict[str, float] = {}
    bars: list[Bar] = []
    for entry in entries:
        if not entry.node or entry.node.partition("@")[0] in inner:
            continue
        if isinstance(entry.event, NodeStarted):
            begun[entry.node] = entry.time_s
        elif isinstance(entry.event, NodeEnded) and entry.node in begun:
            name, result = leaf_name(entry.node), entry.event.status.value
            from_s = begun.pop(entry.node)
            bars.append(Bar(name, from_s, entry.time_s, result, entry.event.reason))
    last_s = entries[-1].time_s if entries else 0.0
    for node, from_s in begun.items():
        bars.append(Bar(leaf_name(node), from_s, last_s, _UNFINISHED, ""))
    return sorted(bars, key=lambda bar: bar.from_s)


def _parents(node: str) -> Iterator[str]:
    """Yield the paths of all nodes above a node; `@retry` marks a modifier of the same node."""
    while "/" in node:
        node = node.rpartition("/")[0]
        yield node


def attempt_bars(picks: Iterable[PickReport]) -> Iterator[Bar]:
    """Yield a bar an attempt at a stone, from the report."""
    for pick in picks:
        for one in pick.attempts:
            name = f"stone {pick.object}"
            yield Bar(name, one.started_s, one.ended_s, one.outcome, one.reason)


def timeline(bars: Sequence[Bar]) -> Spec:
    """Return the chart: a row a name, in the order in which the names first occur."""
    y, height = rows(list(dict.fromkeys(bar.name for bar in bars)))
    results = list(dict.fromkeys(bar.result for bar in bars))
    colours = [_COLOURS.get(result, ACCENT) for result in results]
    tooltip = [
        {"field": "name", "title": "what"},
        {"field": "from", "title": "from [s]"},
        {"field": "to", "title": "to [s]"},
        {"field": "result", "title": "result"},
        {"field": "words", "title": "reason"},
    ]
    encoding = {
        "y": y,
        "x": {"field": "from", "type": "quantitative", "title": "mission time [s]"},
        "x2": {"field": "to"},
        "color": {
            "field": "result",
            "type": "nominal",
            "scale": {"domain": results, "range": colours},
            "legend": {"orient": "top"},
        },
        "tooltip": tooltip,
    }
    # A leaf that answers at once has a bar without a width: a tick shows it.
    layers: list[Spec] = [
        {"mark": {"type": "bar", "height": 12}, "encoding": encoding},
        {"mark": {"type": "tick", "thickness": 2, "size": 12}, "encoding": _at_once(encoding)},
    ]
    return specification([_value(bar) for bar in bars], layers, height=height)


def _at_once(encoding: Spec) -> Spec:
    return {channel: field for channel, field in encoding.items() if channel != "x2"}


def _value(bar: Bar) -> dict[str, Any]:
    return {
        "row": row_name(bar.name),
        "name": bar.name,
        "from": round(bar.from_s, 3),
        "to": round(bar.to_s, 3),
        "result": bar.result,
        "words": bar.words,
    }
