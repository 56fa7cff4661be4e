"""The results as tables for other programs: one row a run, as CSV and as Parquet."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from executive.campaign.reporting.quantile import quantile
from executive.campaign.reporting.result import Result
from executive.campaign.reporting.summary import MetricWords
from executive.interfaces.metric import Share, Values

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
            lists = pa.array(list(_values(name, results)), pa.list_(pa.float64()))
            columns[name] = lists
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


def _of_values(metric: str, results: Sequence[Result]) -> dict[str, list[float | int | None]]:
    ordered = [None if v is None else sorted(v) for v in _values(metric, results)]
    return {
        f"{metric}.median": [quantile(v, 0.5) if v else None for v in ordered],
        f"{metric}.p95": [quantile(v, 0.95) if v else None for v in ordered],
        f"{metric}.max": [v[-1] if v else None for v in ordered],
        f"{metric}.n": [None if v is None else len(v) for v in ordered],
    }


def _values(metric: str, results: Sequence[Result]) -> Iterator[Sequence[float] | None]:
    for one in results:
        measured = one.measurements.get(metric)
        yield measured.values if isinstance(measured, Values) else None
