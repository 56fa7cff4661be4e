"""Figures as people read them."""

import math
from collections.abc import Iterable, Sequence

from executive.campaign.figures.figures import Interval

NOTHING = "–"  # where nothing can be said


def amount(value: float, unit: str = "") -> str:
    """Return a value with three significant digits and its unit."""
    if not math.isfinite(value):
        return NOTHING
    if unit == "byte":
        return f"{value / 2**20:,.0f} MiB"
    return f"{_digits(value)} {unit}".rstrip()


def _digits(value: float) -> str:
    size = abs(value)
    if size >= 100 or value == int(value):
        return f"{value:,.0f}"
    if size < 1e-4:
        return f"{value:.2e}"
    return f"{value:.{2 - math.floor(math.log10(size))}f}"


def percent(share: float) -> str:
    """Return a share in percent; a tenth of a percent is shown near 0 and 100 %."""
    if not math.isfinite(share):
        return NOTHING
    in_percent = 100 * share
    is_at_the_edge = 0 < in_percent < 1.5 or 98.5 < in_percent < 100
    return f"{in_percent:.{1 if is_at_the_edge else 0}f} %"


def points(difference: float) -> str:
    """Return a difference of shares in percentage points, with its sign."""
    return f"{100 * difference:+.1f} points" if math.isfinite(difference) else NOTHING


def figure(value: float, unit: str, is_share: bool) -> str:
    """Return a share in percent, or a value with its unit."""
    return percent(value) if is_share else amount(value, unit)


def interval(of: Interval, unit: str = "", is_share: bool = False) -> str:
    """Return an interval; a dash where nothing can be said."""
    low, high = figure(of.low, unit, is_share), figure(of.high, unit, is_share)
    if NOTHING in (low, high):
        one_side = f"≥ {low}" if low != NOTHING else f"≤ {high}"
        return NOTHING if low == high else one_side
    unit_of_both = "%" if is_share else "MiB" if unit == "byte" else unit
    return f"{low.removesuffix(unit_of_both).rstrip()} to {high}"


def number_ranges(numbers: Iterable[int]) -> str:
    """Return whole numbers with runs of neighbours put together, such as `1–20, 25`."""
    ranges: list[list[int]] = []
    for number in sorted(set(numbers)):
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}–{b}" for a, b in ranges)


def wrapped(text: str, width: int = 26) -> str:
    """Return a text with line breaks after punctuation and spaces, for labels of charts."""
    lines = [""]
    for part in _parts(text):
        if lines[-1] and len(lines[-1]) + len(part.rstrip()) > width:
            lines.append("")
        lines[-1] += part
    return "\n".join(line.strip() for line in lines)


def _parts(text: str) -> Sequence[str]:
    parts, start = [], 0
    for end, letter in enumerate(text, 1):
        if letter in ", .=-_/" or end - start >= 26:
            parts.append(text[start:end])
            start = end
    return [*parts, text[start:]]


def shortened(text: str, most: int) -> str:
    """Return a text, cut with an ellipsis if it is longer."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


def plural(count: int, noun: str) -> str:
    """Return a count with its noun, such as `3 runs`."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"
