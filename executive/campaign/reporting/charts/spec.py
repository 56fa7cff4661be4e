"""What all charts have in common: size, fonts, colours, and rows of cells."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from executive.campaign.reporting.wording import wrapped

Spec = dict[str, Any]

INK = "#1c2127"
ACCENT = "#0b63a5"
SOFT = "#8a949e"
GOOD = "#1a7f4e"
BAD = "#b3261e"
TAIL = "#d55e00"
LIMIT = BAD
# Okabe and Ito's colours, which colour-blind people tell apart, without yellow: too pale on paper.
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
MOST_ROWS = 60  # of one chart; a table has the rest

_LINE = 13  # height of a line of a label [px]
_FONT = "Liberation Sans, Arial, Helvetica, sans-serif"
_CONFIG: Spec = {
    "font": _FONT,
    "view": {"stroke": None},
    "axis": {
        "labelColor": INK,
        "titleColor": "#5c6670",
        "titleFontWeight": "normal",
        "labelFontSize": 12,
        "titleFontSize": 12,
        "gridColor": "#e8ebee",
        "domain": False,
        "ticks": False,
        "labelPadding": 6,
        "labelLimit": 400,
    },
    "axisX": {"titlePadding": 8, "labelFlush": False, "labelOverlap": "greedy"},
    "legend": {"labelFontSize": 12, "labelLimit": 400, "title": None, "symbolStrokeWidth": 3},
    "title": {
        "fontSize": 14,
        "anchor": "start",
        "subtitleFontSize": 12,
        "subtitleColor": "#5c6670",
    },
    "range": {"category": list(PALETTE)},
}


def specification(
    values: Sequence[Mapping[str, Any]], layers: Sequence[Mapping[str, Any]], **more: Any
) -> Spec:
    """Return a specification of layers over one table of values, as wide as its place."""
    return {
        "$schema": "https://vega.github.io/schema/vega-lite/v6.json",
        "width": "container",
        "autosize": {"type": "fit-x", "contains": "padding"},
        "data": {"values": list(values)},
        "layer": list(layers),
        "config": _CONFIG,
        **more,
    }


def rows(names: Sequence[str], title: str = "") -> tuple[Spec, Spec]:
    """Return the axis of a chart with a row for each name, and the height of a row.

    A long name is broken into lines, and no name is cut off.

    Args:
        names: The names, from top to bottom.
        title: What they are, above them.
    """
    labels = [wrapped(name) for name in names]
    most = max((_lines(label) for label in labels), default=1)
    # Vega begins a label at the middle of its row. The longest is raised by half of its height, and
    # shorter ones begin with as many half lines as bring their middle to the same place. A line
    # without any letter would be left out.
    blank = "\u200b\n"
    halves = {
        label: blank * (most - _lines(label)) + label.replace("\n", f"\n{blank}")
        for label in labels
    }
    axis = {
        "labelExpr": f"split({json.dumps(halves)}[datum.label], '\\n')",
        "labelBaseline": "middle",
        "labelLineHeight": _LINE / 2,
        "labelOffset": -(most - 1) * _LINE / 2,
        "title": title or None,
        "titleAngle": 0,
        "titleAlign": "right",
        "titleBaseline": "bottom",
        "titleAnchor": "end",
        "titleX": -6,
        "titleY": -4,
        "grid": True,
    }
    encoding = {"field": "row", "type": "nominal", "sort": labels, "axis": axis}
    return encoding, {"step": max(26, _LINE * most + 10)}


def _lines(label: str) -> int:
    return label.count("\n") + 1


def row_name(name: str) -> str:
    """Return what the field `row` of a value holds for a name."""
    return wrapped(name)


def as_picture(chart: Mapping[str, Any], title: str) -> Spec:
    """Return the chart with its title and a fixed width, to be drawn as a file."""
    return {**chart, "width": 640, "autosize": {"type": "pad"}, "title": title, "padding": 16}
