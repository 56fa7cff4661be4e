"""Bounds held against figures."""

import math
from collections.abc import Iterator, Sequence

from executive.campaign.figures.bound import Bound
from executive.campaign.figures.figures import Estimate, Interval, Judgement

_NOTHING = (math.nan, Interval(math.nan, math.nan))


def judgements_of(bounds: Sequence[Bound], estimates: Sequence[Estimate]) -> Iterator[Judgement]:
    """Yield the judgement of each bound in each cell that it is for.

    A bound without a cell, because no such run has ended, is missed.
    """
    for bound in bounds:
        cells = [
            one for one in estimates if one.metric == bound.metric and bound.is_for(one.levels)
        ]
        for one in cells:
            yield _judged(bound, one)
        if not cells:
            yield Judgement(bound, bound.where, *_NOTHING, is_met=False, is_sure=False)


def _judged(bound: Bound, estimate: Estimate) -> Judgement:
    value, interval = estimate.statistics.get(bound.statistic, _NOTHING)
    is_met = _is_within(value, bound)
    # The end of the interval that is nearest to the wrong side of the verdict; NaN is never sure.
    end = interval.low if bound.is_least == is_met else interval.high
    is_sure = not math.isnan(end) and _is_within(end, bound) == is_met
    return Judgement(bound, estimate.levels, value, interval, is_met, is_sure)


def _is_within(value: float, bound: Bound) -> bool:
    room = 1e-9 * max(1.0, abs(bound.limit))  # a sum of binary fractions is not taken for a miss
    if bound.is_least:
        return value >= bound.limit - room
    return value <= bound.limit + room
