"""A limit that a campaign sets on a figure."""

from collections.abc import Mapping
from dataclasses import dataclass, field

# What a bound may be set on: `share` of metrics that are shares, the others of values.
STATISTICS = ("share", "median", "p90", "p95", "max", "min")


@dataclass(frozen=True, slots=True)
class Bound:
    """A limit on a statistic of a metric.

    Attributes:
        metric: Installed name of the metric.
        statistic: One of `STATISTICS`.
        limit: The limit, in the metric's unit.
        is_least: Whether the statistic has to be at least, not at most, the limit.
        where: Levels that the bound is for; it holds for every cell if empty.
        excepted: Levels that it is not for, such as a control without what is measured.
    """

    metric: str
    statistic: str
    limit: float
    is_least: bool
    where: Mapping[str, str] = field(default_factory=dict)
    excepted: Mapping[str, str] = field(default_factory=dict)

    def is_for(self, levels: Mapping[str, str]) -> bool:
        """Return whether it holds for a cell with these levels."""
        is_excepted = bool(self.excepted) and self.excepted.items() <= levels.items()
        return self.where.items() <= levels.items() and not is_excepted
