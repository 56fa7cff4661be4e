"""What paired differences say, as a verdict and in words."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import special

from executive.arrays import Float
from executive.campaign.figures.figures import Interval
from executive.campaign.figures.intervals.level import TAIL, Z
from executive.campaign.figures.intervals.pairs import sign_test

_POWER = 0.8  # probability with which the suggested number of seeds tells
# An interval reaches the edge of telling at half that power; so many times the pairs are needed.
_MORE_PAIRS = ((Z + float(special.ndtri(_POWER))) / Z) ** 2
_LARGEST = 20_000  # beyond it, a number of seeds is not worth stating


@dataclass(frozen=True, slots=True)
class Pairs:
    """What the pairs of a level and its baseline say.

    Attributes:
        gains: Level minus baseline by pair, shape (K,).
        difference: Level minus baseline over all pairs.
        interval: Its confidence interval.
        margin: Difference that would matter, in the unit of the difference.
        sign: 1 where more is better, else −1.
        unit: Unit of the difference; `points` for shares, of which 100 are 1.
        interval_of: The interval of other pairs, by the indices of the pairs that they repeat.
    """

    gains: Float
    difference: float
    interval: Interval
    margin: float
    sign: int
    unit: str
    interval_of: Callable[[np.ndarray], Interval]


def verdict_of(pairs: Pairs) -> tuple[str, str]:
    """Return the verdict and its sentence."""
    verdict = _verdict(pairs.interval, pairs.margin, pairs.sign)
    words = {"better": "better", "worse": "worse", "alike": "no difference that matters"}
    if verdict in ("better", "worse"):
        return verdict, f"{words[verdict]}: {_figure(pairs)}"
    beyond = pairs.gains[np.abs(pairs.gains) > pairs.margin] * pairs.sign
    better, worse = int((beyond > 0).sum()), int((beyond < 0).sum())
    if pairs.unit != "points" and sign_test(better, worse) <= 2 * TAIL:
        # More than half of the pairs may be equal, which the median does not see beyond.
        verdict = "better" if better > worse else "worse"
        return verdict, f"{verdict}: {_seldom(pairs, better, worse)}"
    if verdict == "alike":
        return verdict, f"{words[verdict]}: {_figure(pairs)}"
    return verdict, f"too few seeds to tell: {_figure(pairs)}; {_needed(pairs)}"


def _verdict(interval: Interval, margin: float, sign: int) -> str:
    if math.isnan(interval.low) or math.isnan(interval.high):
        return "too_few"
    if -margin <= interval.low and interval.high <= margin:
        return "alike"
    low, high = sorted((sign * interval.low, sign * interval.high))
    if low > 0:
        return "better"
    return "worse" if high < 0 else "too_few"


def _figure(pairs: Pairs) -> str:
    number = len(pairs.gains)
    if not number:
        return "no seed has both"
    scale, unit = _shown(pairs.unit)
    ends = (scale * pairs.interval.low, scale * pairs.interval.high)
    between = "no interval" if any(map(math.isnan, ends)) else f"{ends[0]:+.3g} to {ends[1]:+.3g}"
    return f"{scale * pairs.difference:+.3g}{unit} ({between}) on {number} seeds"


def _seldom(pairs: Pairs, better: int, worse: int) -> str:
    scale, unit = _shown(pairs.unit)
    return (
        f"by more than {scale * pairs.margin:.3g}{unit} better on {better} and worse on {worse} of"
        f" {len(pairs.gains)} seeds, though in the median {scale * pairs.difference:+.3g}{unit}"
    )


def _shown(unit: str) -> tuple[float, str]:
    """Return what figures are multiplied by where people read them, and the unit behind them."""
    shown = {"points": (100.0, " points"), "byte": (2.0**-20, " MiB"), "": (1.0, "")}
    return shown.get(unit, (1.0, f" {unit}"))


def _needed(pairs: Pairs) -> str:
    """Say how many pairs would tell with the power, if further ones are like those seen."""
    number = len(pairs.gains)
    if not number:
        return "both have to run on the same seeds"

    def tells(count: int) -> bool:
        interval = pairs.interval_of(np.resize(np.arange(number), count))
        return _verdict(interval, pairs.margin, pairs.sign) != "too_few"

    low, high = number, 2 * number
    while not tells(high):
        low, high = high, 2 * high
        if high > _LARGEST:
            return f"more than {_LARGEST} seeds would be needed"
    while high - low > max(1, low // 50):
        middle = (low + high) // 2
        low, high = (low, middle) if tells(middle) else (middle, high)
    return f"some {_rounded(high * _MORE_PAIRS)} would probably do"


def _rounded(number: float) -> int:
    """Round up to two digits."""
    step: int = 10 ** max(0, math.floor(math.log10(number)) - 1)
    return math.ceil(number / step) * step
