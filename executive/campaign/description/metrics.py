"""Reads what a campaign reports: metrics, with bounds on their statistics."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from executive import registry
from executive.campaign.description.factors import Factor, level_name
from executive.campaign.figures.bound import STATISTICS, Bound
from executive.campaign.figures.measurement import metric
from executive.config import UNITS, parse_quantity
from executive.errors import ConfigError, did_you_mean
from executive.interfaces.metric import Metric
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.value import Listing, Scalar, Table, TableEntry, Value, describe, without

SHARE = "share"
OF_VALUES = tuple(one for one in STATISTICS if one != SHARE)
LIMITS = ("at_least", "at_most")
WHERE, EXCEPT = "where", "except"
# What is compared if a campaign names no metrics. Each comparison of a metric that does not differ
# has a chance of one in twenty to say that it does, so that not all of them are compared.
MAIN = ("success", "placed", "first_attempt", "placement_error", "cycle_time")


def installed_metrics() -> tuple[str, ...]:
    """List the installed metrics by name."""
    return registry.names(registry.METRICS)


class MetricReader:
    """Reads `metrics:`; a metric that is not installed is a mistake."""

    def __init__(self, factors: Sequence[Factor], reading: Reading) -> None:
        self._levels = {f.name: [level.name for level in f.levels] for f in factors}
        self._reading = reading

    def read(self, value: Value | None) -> tuple[tuple[str, ...], tuple[Bound, ...]]:
        """Return the names of the metrics, in order, and the bounds; all installed ones if none."""
        if value is None:
            return installed_metrics(), ()
        metrics: dict[str, Metric] = {}
        bounds: list[Bound] = []
        for name, entry in self._entries(value).items():
            found = self._metric(name, entry.key_mark)
            if found is not None:
                metrics[name] = found
                bounds += self._bounds(name, found, entry.value)
        return tuple(metrics), tuple(bounds)

    def names(self, value: Value, reported: Sequence[str]) -> tuple[str, ...]:
        """Return the metrics of a list, each of which has to be reported."""
        listing = self._reading.listing(value, "'metrics'")
        found = []
        for item in listing.items if listing else ():
            name = self._reading.text(item, "a metric")
            if name in reported:
                found.append(str(name))
            elif name in installed_metrics():
                self._reading.fail(item, f"'{name}' is not reported; add it to 'metrics'")
            elif name is not None:
                self._reading.fail(item, f"no metric '{name}'{did_you_mean(name, reported)}")
        return tuple(found)

    def _entries(self, value: Value) -> Mapping[str, TableEntry]:
        if not isinstance(value, Listing):
            table = self._reading.table(value, "'metrics'")
            return table.entries if table else {}
        names = ((self._reading.text(item, "a metric"), item) for item in value.items)
        return {
            name: TableEntry(item.mark, Scalar(None, item.mark)) for name, item in names if name
        }

    def _metric(self, name: str, mark: Mark) -> Metric | None:
        try:
            return metric(name)
        except ConfigError as error:
            self._reading.problems.error(mark, str(error))
            return None

    # --- bounds

    def _bounds(self, name: str, measured: Metric, value: Value) -> Iterator[Bound]:
        for item in value.items if isinstance(value, Listing) else (value,):
            if isinstance(item, Scalar) and item.value is None:
                continue
            table = self._reading.table(item, f"the bounds of '{name}'")
            if table is None:
                continue
            limits = without(table, [WHERE, EXCEPT])
            keys = sorted(table.entries.keys() - limits.entries.keys())
            if keys and not limits.entries:
                told = f"'{keys[-1]}' says for which levels a bound is or is not; give a bound"
                self._reading.fail(table, told)
            where, excepted = self._cells(table, WHERE), self._cells(table, EXCEPT)
            for bound in self._of_a_table(name, measured, limits):
                yield replace(bound, where=where, excepted=excepted)

    def _of_a_table(self, name: str, measured: Metric, table: Table) -> Iterator[Bound]:
        if measured.is_share:
            for key in (one for one in table.entries if one in STATISTICS):
                mark = table.entries[key].key_mark
                told = f"'{name}' is a share: write 'at_least' or 'at_most' without '{key}'"
                self._reading.problems.error(mark, told)
            rest = without(table, STATISTICS)
            yield from self._limits(name, measured, SHARE, rest)
            return
        for key in (one for one in table.entries if one in LIMITS):
            mark = table.entries[key].key_mark
            told = f"'{name}' has values: say of which statistic, such as {{median: {{{key}: …}}}}"
            self._reading.problems.error(mark, told)
        rest = without(table, LIMITS)
        self._reading.known_keys(rest, (*OF_VALUES, WHERE, EXCEPT), f"'{name}'")
        for statistic in (one for one in rest.entries if one in OF_VALUES):
            inner = self._reading.table(
                rest.entries[statistic].value, f"the bound of '{statistic}'"
            )
            if inner is not None:
                yield from self._limits(name, measured, statistic, inner)

    def _limits(
        self,
        name: str,
        measured: Metric,
        statistic: str,
        table: Table,
    ) -> Iterator[Bound]:
        what = f"'{name}'" if statistic == SHARE else f"the bound of '{statistic}'"
        self._reading.known_keys(table, LIMITS, what)
        for key in LIMITS:
            value = table.get(key)
            limit = None if value is None else self._limit(key, value, measured)
            if limit is not None:
                yield Bound(name, statistic, limit, key == "at_least")

    def _limit(self, key: str, value: Value, measured: Metric) -> float | None:
        if measured.is_share:
            return read_share(value, f"'{key}'", self._reading)
        try:
            if isinstance(value, Scalar):
                return parse_in_unit(value.value, measured.unit)
            told = f"a number, not {describe(value)}"
        except ValueError as error:
            told = str(error)
        self._reading.fail(value, f"'{key}': {told}")
        return None

    def _cells(self, table: Table, key: str) -> Mapping[str, str]:
        """Return the levels of some factors that `where` or `except` names."""
        value = table.get(key)
        levels = self._reading.table(value, f"'{key}'") if value is not None else None
        if levels is None:
            return {}
        self._reading.known_keys(levels, self._levels, f"'{key}'")
        return {
            factor: name
            for factor, entry in levels.entries.items()
            if factor in self._levels
            if (name := self.level(factor, entry.value)) is not None
        }

    def level(self, factor: str, value: Value) -> str | None:
        """Return the name of a level of a factor."""
        name = level_name(value)
        if name is None:
            self._reading.fail(value, f"a level is a name, not {describe(value)}")
        elif name not in self._levels[factor]:
            near = did_you_mean(name, self._levels[factor])
            self._reading.fail(value, f"factor '{factor}' has no level '{name}'{near}")
            return None
        return name


def read_share(value: Value, what: str, reading: Reading) -> float | None:
    """Return a share: a number from 0 to 1, or a text such as `95 %`."""
    got = value.value if isinstance(value, Scalar) else None
    if isinstance(got, str) and got.strip().endswith("%"):
        try:
            got = float(got.strip().removesuffix("%")) / 100
        except ValueError:
            got = None
    if isinstance(got, int | float) and not isinstance(got, bool) and 0 <= got <= 1:
        return float(got)
    told = f"{what} is a share from 0 to 1, such as 0.95 or 95 %, not {describe(value)}"
    reading.fail(value, told)
    return None


def parse_in_unit(value: object, unit: str) -> float:
    """Return a quantity in a metric's unit; a text may bring another unit of the same dimension.

    Raises:
        ValueError: If it is no number, or its unit is of another dimension.
    """
    symbol = "B" if unit == "byte" else unit
    dimension = next((d for d, units in UNITS.items() if symbol in units), None)
    if isinstance(value, str) and dimension is not None:
        return parse_quantity(value, dimension) / UNITS[dimension][symbol]
    if isinstance(value, int | float) and not isinstance(value, bool) and value == value:
        return float(value)
    raise ValueError(f"expected a number{f' in {unit}' if unit else ''}, got {value!r}")
