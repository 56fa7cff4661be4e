"""The figures of a campaign: what its tables, pictures, verdicts and documents are made of."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.campaign.figures.bound import Bound


@dataclass(frozen=True, slots=True)
class Interval:
    """A confidence interval of 95 %; an end is NaN where nothing can be said on that side."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Estimate:
    """A metric over the runs of one cell (one combination of levels).

    Attributes:
        metric: Installed name of the metric.
        levels: The cell.
        runs: Number of runs of the cell, those without an answer included.
        without_answer: Number of runs that crashed, were killed or exceeded a limit.
        measured: Number of runs that hold something to measure the metric on.
        hits: Of a share: hits of all runs together; else 0.
        of: Of a share: trials of all runs together; of values: number of values.
        statistics: `share` with its interval, or `median`, `p90`, `p95`, `max`, `min`, each
            with its interval. Of `max` and `min` no sample tells more than that they are at least,
            or at most, what was seen.
        assumed: Of a share: trials, among `of`, of runs that did not end by themselves. They count
            as the worst, and their number was taken from the same seed in another cell, or from the
            median of the runs that tell.
        problems: Number of runs in which the metric raised an error; these are not counted.
    """

    metric: str
    levels: Mapping[str, str]
    runs: int
    without_answer: int
    measured: int
    hits: int
    of: int
    statistics: Mapping[str, tuple[float, Interval]]
    assumed: int
    problems: int


@dataclass(frozen=True, slots=True)
class Difference:
    """A level against the baseline, on the seeds that both have.

    Attributes:
        metric: Installed name of the metric.
        factor: The factor.
        baseline: The level that is compared with.
        level: The level that is compared.
        others: Levels of the other factors.
        pairs: Number of seeds in which both measured something.
        better: Pairs in which the level did better than the baseline.
        worse: Pairs in which it did worse. Both together are the discordant pairs.
        difference: Level minus baseline: of shares, or the median of the paired differences.
        interval: Its confidence interval of 95 %.
        verdict: `better`, `worse`, `alike` (no difference that matters) or `too_few` (runs).
        words: The verdict as a sentence; for `too_few` with the number of seeds that would tell.
        left_out: Seeds that both have, but in which one measured nothing.
        p_value: Of the exact sign test on the discordant pairs; for a share of runs, such as
            `success`, this is McNemar's exact test.
    """

    metric: str
    factor: str
    baseline: str
    level: str
    others: Mapping[str, str]
    pairs: int
    better: int
    worse: int
    difference: float
    interval: Interval
    verdict: str
    words: str
    left_out: int
    p_value: float


@dataclass(frozen=True, slots=True)
class Judgement:
    """A bound held against its figure in one cell.

    Attributes:
        bound: The bound.
        levels: The cell.
        value: The figure; NaN if nothing was measured, which misses every bound.
        interval: Its confidence interval of 95 %.
        is_met: Whether the figure is within the bound.
        is_sure: Whether its whole interval is on the same side of the bound.
    """

    bound: Bound
    levels: Mapping[str, str]
    value: float
    interval: Interval
    is_met: bool
    is_sure: bool


@dataclass(frozen=True, slots=True)
class Figures:
    """All figures of a campaign."""

    estimates: tuple[Estimate, ...]
    differences: tuple[Difference, ...]
    judgements: tuple[Judgement, ...]
