"""Bars with a tail: a group a row, a bar a kind."""

from collections.abc import Sequence
from dataclasses import dataclass

from executive.campaign.reporting.charts.spec import (
    INK,
    PALETTE,
    Spec,
    row_name,
    rows,
    specification,
)

MOST_KINDS = len(PALETTE)
_THICKNESS = 16  # of a bar [px]


@dataclass(frozen=True, slots=True)
class Bar:
    """One bar.

    Attributes:
        name: Name of its row.
        kind: What gives its colour.
        value: Its length.
        tail: Where its tick is.
        words: What is shown when it is pointed at.
    """

    name: str
    kind: str
    value: float
    tail: float
    words: str


def bars_chart(bars: Sequence[Bar], axis_title: str) -> Spec:
    """Return the chart, with a legend if there are several kinds, `MOST_KINDS` at most."""
    kinds = list(dict.fromkeys(bar.kind for bar in bars))
    y, _ = rows(list(dict.fromkeys(bar.name for bar in bars)))
    step = max(30, _THICKNESS * len(kinds) + 12)
    encoding: Spec = {
        "y": {**y, "scale": {"paddingInner": 0.25, "paddingOuter": 0.1}},
        "yOffset": {"field": "kind", "type": "nominal", "sort": kinds},
        "color": {
            "field": "kind",
            "type": "nominal",
            "scale": {"domain": kinds, "range": list(PALETTE[: len(kinds)])},
            "legend": {"orient": "top", "columns": 2} if len(kinds) > 1 else None,
        },
    }
    tooltip = [{"field": "name"}, {"field": "kind"}, {"field": "words"}]
    x = {"type": "quantitative", "axis": {"title": axis_title, "tickCount": 6}}
    length = {**encoding, "x": {**x, "field": "value"}, "tooltip": tooltip}
    tail = {**encoding, "x": {**x, "field": "tail"}, "color": {"value": INK}}
    layers: list[Spec] = [
        {"mark": {"type": "bar"}, "encoding": length},
        {"mark": {"type": "tick", "thickness": 2}, "encoding": tail},
    ]
    return specification(
        [_value(bar) for bar in bars], layers, height={"step": step, "for": "position"}
    )


def _value(bar: Bar) -> dict[str, str | float]:
    return {
        "row": row_name(bar.name),
        "name": bar.name,
        "kind": bar.kind,
        "value": bar.value,
        "tail": bar.tail,
        "words": bar.words,
    }
