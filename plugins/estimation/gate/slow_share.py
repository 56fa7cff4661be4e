"""Which share of what a sensor declares does not scatter: an error that changes slowly.

A filter averages what scatters from fix to fix. A float solution, or reflections at a place, err
by the same vector for seconds: its differences are small beside what it declares, and the mean of
many such fixes is no better than one of them.
"""

import math
from functools import lru_cache

import numpy as np
from executive_plugins.estimation.gate.innovation_alarm import FALSE_ALARM_S
from numba import njit

from executive.arrays import Float, Int
from executive.geometry import chi_square

# Pairs of innovations over which the scatter is looked at; that of more pairs is known better.
WINDOWS = (3, 6, 12)
PAIRS = WINDOWS[-1]  # that are kept
_UPPER = 0.05  # probability of a scatter that is smaller than the one that was seen


@lru_cache(maxsize=64)
def quiet_limits(degrees: int, period_s: float) -> Float:
    """Return the sum below which each window is too quiet for chance, once in `FALSE_ALARM_S`.

    The squared difference of two innovations that are white has half of it distributed as χ².

    Args:
        degrees: Length of an innovation.
        period_s: Usual time between two innovations [s].
    """
    chance = 2 * period_s / (FALSE_ALARM_S * len(WINDOWS))
    return np.array([chi_square.quantile(chance, degrees * pairs) for pairs in WINDOWS])


@lru_cache(maxsize=8)
def usual_sums(degrees: int) -> Float:
    """Return the sum of each window that innovations which scatter as declared exceed by 95 %."""
    return np.array([chi_square.quantile(_UPPER, degrees * pairs) for pairs in WINDOWS])


@njit(cache=True)  # type: ignore[untyped-decorator]
def slow_share(
    sums: Float, counts: Int, before: Float, white: Float, limits: Float, usual: Float
) -> float:
    """Take an innovation; return the share of the declared variance that does not scatter.

    Pairs do not overlap, so that their differences are independent.

    Args:
        sums: Half the squared differences of the newest pairs, newest first, shape (`PAIRS`,).
        counts: Number of sums in use, and whether the first of a pair was taken, shape (2,).
        before: The first of the pair, in standard deviations, shape (m,).
        white: The innovation in standard deviations, shape (m,).
        limits: See `quiet_limits`.
        usual: See `usual_sums`.

    Returns:
        The share, by the upper bound of 95 % of what scatters in the longest window that is too
        quiet for chance; 0 if none is.
    """
    if counts[1] == 0:
        for j in range(len(white)):
            before[j] = white[j]
        counts[1] = 1
    else:
        counts[1] = 0
        counts[0] = min(counts[0] + 1, len(sums))
        for i in range(counts[0] - 1, 0, -1):
            sums[i] = sums[i - 1]
        sums[0] = 0.0
        for j in range(len(white)):
            sums[0] += 0.5 * (white[j] - before[j]) ** 2
    share, total, begun = 0.0, 0.0, 0
    for k in range(len(limits)):
        pairs = WINDOWS[k]
        if counts[0] < pairs:
            break
        for i in range(begun, pairs):
            total += sums[i]
        begun = pairs
        if total < limits[k]:
            share = 1.0 - total / usual[k]
    return share


@njit(cache=True)  # type: ignore[untyped-decorator]
def follow_slowly(slow_m: float, gain: float, variance: float) -> float:
    """Return the deviation of a state by an error of the fixes that changes slowly [m].

    Args:
        slow_m: Before a fix was used [m].
        gain: Share by which the fix has drawn the state to itself.
        variance: Of the slow error of that fix [m²].
    """
    return (1.0 - gain) * slow_m + gain * math.sqrt(variance)
