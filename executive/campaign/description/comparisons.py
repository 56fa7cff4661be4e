"""Reads what a campaign compares with what."""

from collections.abc import Iterator, Sequence

from executive.campaign.description.factors import Factor
from executive.campaign.description.metrics import MAIN, MetricReader, installed_metrics, read_share
from executive.campaign.figures.comparison import Comparison
from executive.errors import did_you_mean
from executive.tree.reading import Reading
from executive.tree.value import Listing, Table, Value

KEYS = ("factor", "baseline", "metrics", "margin")
MARGIN = 0.05


def default_comparisons(
    factors: Sequence[Factor], metrics: tuple[str, ...]
) -> tuple[Comparison, ...]:
    """Compare the levels of each factor with its first one."""
    varied = (factor for factor in factors if len(factor.levels) > 1)
    return tuple(Comparison(one.name, one.levels[0].name, metrics) for one in varied)


class ComparisonReader:
    """Reads `compare:`."""

    def __init__(
        self,
        factors: Sequence[Factor],
        metrics: tuple[str, ...],
        names: MetricReader,
        reading: Reading,
    ) -> None:
        self._factors = factors
        self._metrics = metrics
        is_named = metrics != installed_metrics()
        self._default = metrics if is_named else tuple(one for one in MAIN if one in metrics)
        self._names = names
        self._reading = reading

    def read(self, value: Value | None) -> tuple[Comparison, ...]:
        """Return the comparisons; the default ones if the file says nothing."""
        if value is None:
            return default_comparisons(self._factors, self._default)
        if not isinstance(value, Listing):
            self._reading.fail(value, "'compare' takes a list: [{factor: …, baseline: …}]")
            return ()
        return tuple(self._several(value))

    def _several(self, listing: Listing) -> Iterator[Comparison]:
        for item in listing.items:
            table = self._reading.table(item, "a comparison")
            if table is not None:
                yield from self._one(table)

    def _one(self, table: Table) -> Iterator[Comparison]:
        self._reading.known_keys(table, KEYS, "a comparison")
        factor, baseline = self._factor(table), table.get("baseline")
        if baseline is None:
            self._reading.fail(table, "a comparison needs 'baseline': the level to compare with")
        given, margin = table.get("metrics"), table.get("margin")
        metrics = self._default if given is None else self._names.names(given, self._metrics)
        share = MARGIN if margin is None else read_share(margin, "'margin'", self._reading)
        if factor is None or baseline is None:
            return
        level = self._names.level(factor, baseline)
        if level is not None and share is not None:
            yield Comparison(factor, level, metrics, share)

    def _factor(self, table: Table) -> str | None:
        value = table.get("factor")
        if value is None:
            self._reading.fail(table, "a comparison needs 'factor': what is compared")
            return None
        name = self._reading.text(value, "'factor'")
        known = [factor.name for factor in self._factors]
        if name is None or name in known:
            return name
        self._reading.fail(value, f"no factor '{name}'{did_you_mean(name, known)}")
        return None
