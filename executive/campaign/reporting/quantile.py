"""Quantiles of few values, many times over: plain Python is faster than an array there."""

import math
from collections.abc import Sequence


def quantile(ascending: Sequence[float], share: float) -> float:
    """Return a quantile with linear interpolation, as `numpy.quantile` does by default.

    Args:
        ascending: Values in ascending order; NaN is returned if there are none.
        share: Which one, from 0 to 1.
    """
    if not ascending:
        return math.nan
    position = share * (len(ascending) - 1)
    low = math.floor(position)
    high = min(low + 1, len(ascending) - 1)
    return ascending[low] + (position - low) * (ascending[high] - ascending[low])
