"""What a paired difference with its interval says, as a verdict and in words."""

import math

from scipy import special

from executive.campaign.figures.figures import Interval
from executive.campaign.figures.intervals.level import Z

_POWER = 0.8  # probability with which the suggested number of seeds tells
_LARGEST = 100_000  # beyond it, a number of seeds is not worth stating


def verdict_of(
    difference: float, interval: Interval, margin: float, sign: int, pairs: int
) -> tuple[str, str]:
    """Return the verdict and its sentence.

    Args:
        difference: Level minus baseline.
        interval: Its confidence interval.
        margin: Difference that would matter, in the unit of the difference.
        sign: 1 where more is better, else −1.
        pairs: Number of pairs.
    """
    if math.isnan(interval.low) or math.isnan(interval.high):
        return "too_few", f"{pairs} pairs are too few for an interval"
    if -margin <= interval.low and interval.high <= margin:
        return "alike", "no difference that matters"
    low, high = sorted((sign * interval.low, sign * interval.high))
    if low > 0:
        return "better", "better than the baseline"
    if high < 0:
        return "worse", "worse than the baseline"
    needed = _needed(difference, interval, margin, pairs)
    if needed > _LARGEST:
        return "too_few", f"too few to tell, and more than {_LARGEST} seeds would be needed"
    return "too_few", f"too few to tell; some {needed} seeds would probably do"


def _needed(difference: float, interval: Interval, margin: float, pairs: int) -> int:
    """Return the number of pairs that would tell with the power, if the figures stay as they are.

    Either the interval leaves zero, or it fits within the margin, whichever takes fewer.
    """
    deviation = (interval.high - interval.low) / 2 / Z * math.sqrt(pairs)
    reach = Z + float(special.ndtri(_POWER))
    aims = [abs(difference), margin - abs(difference)]
    numbers = [(reach * deviation / aim) ** 2 for aim in aims if aim > 0]
    needed = min(numbers, default=math.inf)
    if needed > _LARGEST:
        return _LARGEST + 1
    return max(pairs + 1, math.ceil(needed))
