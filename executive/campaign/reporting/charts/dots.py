"""Dots with intervals, a row a cell: shares, medians and tails, differences."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from executive.campaign.figures.figures import Interval
from executive.campaign.reporting.charts.spec import (
    INK,
    LIMIT,
    MOST_ROWS,
    Spec,
    row_name,
    rows,
    specification,
)


@dataclass(frozen=True, slots=True)
class Dot:
    """One dot.

    Attributes:
        name: Name of its row.
        value: Its position; a dot without one (NaN) is left out, its row stays.
        interval: The line about it; NaN for none.
        kind: What it shows, which gives its colour, such as `median`.
        words: What is shown when it is pointed at.
        limit: A bound on it; None if there is none.
    """

    name: str
    value: float
    interval: Interval
    kind: str
    words: str
    limit: float | None = None


def dots_chart(
    dots: Sequence[Dot],
    axis: Mapping[str, Any],
    colours: Mapping[str, str],
    rows_title: str = "",
    scale: Mapping[str, Any] | None = None,
    is_about_zero: bool = False,
) -> Spec:
    """Return the chart.

    Args:
        dots: The dots, row by row; rows beyond `MOST_ROWS` are left out.
        axis: The horizontal axis: `title`, `format` …
        colours: Colour of each kind; with several kinds there is a legend.
        rows_title: What the rows are.
        scale: The horizontal scale; from the data if None.
        is_about_zero: Whether a line marks zero.
    """
    names = list(dict.fromkeys(dot.name for dot in dots))[:MOST_ROWS]
    y, height = rows(names, rows_title)
    x = {
        "field": "value",
        "type": "quantitative",
        "axis": {"tickCount": 5, **axis},
        "scale": scale or {"zero": False, "nice": True},
    }
    legend = {"orient": "top"} if len(colours) > 1 else None
    colour = {
        "field": "kind",
        "type": "nominal",
        "scale": {"domain": list(colours), "range": list(colours.values())},
        "legend": legend,
    }
    tooltip = [
        {"field": "name", "title": "cell"},
        {"field": "kind", "title": "shown"},
        {"field": "words", "title": "figure"},
    ]
    layers: list[Spec] = [
        {
            "transform": [{"filter": "isValid(datum.low)"}],
            "mark": {"type": "rule", "strokeWidth": 4, "opacity": 0.35},
            "encoding": {
                "y": y,
                "x": {**x, "field": "low"},
                "x2": {"field": "high"},
                "color": colour,
            },
        },
        {
            "mark": {"type": "point", "filled": True, "size": 90, "opacity": 1},
            "encoding": {"y": y, "x": x, "color": colour, "tooltip": tooltip},
        },
        {
            "transform": [{"filter": "isValid(datum.limit)"}],
            "mark": {"type": "tick", "thickness": 2, "size": 18, "color": LIMIT},
            "encoding": {
                "y": y,
                "x": {"field": "limit", "type": "quantitative"},
                "tooltip": [{"field": "limit", "title": "bound"}],
            },
        },
    ]
    if is_about_zero:
        zero = {"mark": {"type": "rule", "color": INK}, "encoding": {"x": {"datum": 0}}}
        layers.insert(0, zero)
    shown = set(names)
    values = [_value(dot) for dot in dots if dot.name in shown]
    return specification(values, layers, height=height)


def _value(dot: Dot) -> dict[str, Any]:
    low, high = dot.interval.low, dot.interval.high
    if math.isnan(low) != math.isnan(high):  # one side alone is known: the line ends at the dot
        low, high = (dot.value, high) if math.isnan(low) else (low, dot.value)
    return {
        "row": row_name(dot.name),
        "name": dot.name,
        "kind": dot.kind,
        "value": _number(dot.value),
        "low": _number(low),
        "high": _number(high),
        "words": dot.words,
        "limit": dot.limit,
    }


def _number(value: float) -> float | None:
    return float(f"{value:.5g}") if math.isfinite(value) else None
