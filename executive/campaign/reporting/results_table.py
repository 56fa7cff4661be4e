"""The results as tables for other programs: one row a run, as CSV and as Parquet."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from executive.campaign.reporting.quantile import quantile
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.summary import MetricWords
from executive.interfaces.metric import Measurement, Share, Values

_FIXED = (
    "number",
    "seed",
    "status",
    "outcome",
    "reason",
    "wall_s",
    "cpu_s",
    "peak_memory_bytes",
    "tries",
    "worker",
)


def write_tables(
    folder: Path,
    results: Sequence[Result],
    factors: Sequence[str],
    metrics: Mapping[str, MetricWords],
) -> None:
    """Write `results.csv` and `results.parquet`.

    Columns are those of `Result`; one a factor (`factor.NAME` where the name is taken); of a metric
    of shares `NAME.hits` and `NAME.of`; of a metric of values `NAME.median`, `NAME.p95`,
    `NAME.max`, `NAME.n`, and in Parquet the list `NAME`.
    """
    import pyarrow as pa
    from pyarrow import parquet

    columns = _columns(results, factors, metrics)
    names = list(columns)
    partial = folder / "results.csv.partial"
    with partial.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows(zip(*columns.values(), strict=True))
    partial.replace(folder / "results.csv")

    for name, words in metrics.items():
        if not words.is_share:
            columns[name] = pa.array(_lists(name, results), pa.list_(pa.float64()))
    partial = folder / "results.parquet.partial"
    parquet.write_table(pa.table(columns), partial)
    partial.replace(folder / "results.parquet")


def _columns(
    results: Sequence[Result], factors: Sequence[str], metrics: Mapping[str, MetricWords]
) -> dict[str, Any]:
    columns: dict[str, Any] = {
        "number": [one.trial.number for one in results],
        "seed": [one.trial.seed for one in results],
    }
    for factor in factors:
        name = f"factor.{factor}" if factor in (*_FIXED, *metrics) else factor
        columns[name] = [one.trial.levels.get(factor, "") for one in results]
    columns["status"] = [one.status.value for one in results]
    columns |= {name: [getattr(one, name) for one in results] for name in _FIXED[3:]}
    for metric, words in metrics.items():
        columns |= _of_shares(metric, results) if words.is_share else _of_values(metric, results)
    return columns


def _of_shares(metric: str, results: Sequence[Result]) -> dict[str, list[int | None]]:
    measured = [one.measurements.get(metric) for one in results]
    return {
        f"{metric}.hits": [m.hits if isinstance(m, Share) else None for m in measured],
        f"{metric}.of": [m.of if isinstance(m, Share) else None for m in measured],
    }


def _of_values(metric: str, results: Sequence[Result]) -> dict[str, Sequence[float | int | None]]:
    told = [_told(one.measurements.get(metric)) for one in results]
    names = (f"{metric}.{statistic}" for statistic in ("median", "p95", "max", "n"))
    columns = zip(*told, strict=True) if told else [()] * 4
    return dict(zip(names, columns, strict=True))


def _told(measured: Measurement | None) -> tuple[float | int | None, ...]:
    """Return median, 95th percentile, largest and number of the values of one run."""
    if not isinstance(measured, Values):
        return (None, None, None, None)
    values = measured.values
    if len(values) <= 1:  # nearly half of all cells of the table
        first = values[0] if values else None
        return (first, first, first, len(values))
    ordered = sorted(values)
    return (quantile(ordered, 0.5), quantile(ordered, 0.95), ordered[-1], len(ordered))


def _lists(metric: str, results: Sequence[Result]) -> list[Sequence[float] | None]:
    measured = (one.measurements.get(metric) for one in results)
    return [one.values if isinstance(one, Values) else None for one in measured]
