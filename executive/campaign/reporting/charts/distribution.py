"""The distribution of a metric's values: the share of values up to a value, a line a cell."""

from collections.abc import Iterable, Mapping, Sequence

from executive.campaign.reporting.charts.spec import INK, PALETTE, Spec, specification
from executive.campaign.reporting.quantile import quantile

MOST_LINES = len(PALETTE)  # more cells cannot be told apart by colour
_STEPS = 100


def distribution_chart(cells: Mapping[str, Sequence[float]], axis: Mapping[str, str]) -> Spec:
    """Return empirical distribution functions with their medians and 95th percentiles.

    Args:
        cells: Values in ascending order by the cell's name, `MOST_LINES` at most. Beyond 100 values
            a line is drawn through percentiles.
        axis: The horizontal axis: its `title` with the unit, and the `format` of its numbers.
    """
    shown = {name: values for name, values in cells.items() if values}
    points = [
        {"cell": name, "value": float(f"{value:.5g}"), "share": round(share, 4)}
        for name, values in shown.items()
        for value, share in _steps(values)
    ]
    marks = [
        {"cell": name, "value": float(f"{quantile(values, share):.5g}"), "share": share}
        for name, values in shown.items()
        for share in (0.5, 0.95)
    ]
    x = {
        "field": "value",
        "type": "quantitative",
        "axis": {"tickCount": 6, **axis},
        "scale": {"type": _scale(shown.values()), "nice": True, "zero": False},
    }
    y = {
        "field": "share",
        "type": "quantitative",
        "scale": {"domain": [0, 1]},
        "axis": {"title": "share of values up to this one", "format": "%", "values": _TICKS},
    }
    colour = {
        "field": "cell",
        "type": "nominal",
        "sort": list(shown),
        "scale": {"domain": list(shown), "range": list(PALETTE[: len(shown)])},
        "legend": {"orient": "top", "columns": 2} if len(shown) > 1 else None,
    }
    tooltip = [
        {"field": "cell", "title": "cell"},
        {"field": "share", "title": "share up to", "format": ".0%"},
        {"field": "value", "title": axis["title"]},
    ]
    encoding = {"x": x, "y": y, "color": colour}
    layers: list[Spec] = [
        {
            "mark": {"type": "line", "interpolate": "step-after", "strokeWidth": 2},
            "encoding": encoding,
        },
        {
            "data": {"values": marks},
            "mark": {"type": "point", "filled": True, "size": 70, "stroke": INK, "opacity": 1},
            "encoding": {**encoding, "tooltip": tooltip},
        },
    ]
    return specification(points, layers, height=280)


_TICKS = (0, 0.25, 0.5, 0.75, 0.95, 1)


def _steps(values: Sequence[float]) -> list[tuple[float, float]]:
    """Return the points of a step function: a value, and the share of values up to it."""
    count = len(values)
    if count <= _STEPS:
        return [(values[0], 0.0), *((value, (n + 1) / count) for n, value in enumerate(values))]
    shares = [n / _STEPS for n in range(_STEPS + 1)]
    return [(quantile(values, share), share) for share in shares]


def _scale(cells: Iterable[Sequence[float]]) -> str:
    """Return `log` where the tail is so long that most values would be one point."""
    together = sorted(value for values in cells for value in values)
    is_long = bool(together) and together[-1] > 50 * quantile(together, 0.5)
    return "log" if is_long and together[0] > 0 else "linear"
