"""Measurements of one run: what it left behind, its metrics, and both as JSON holds them."""

import logging
import math
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from executive import registry
from executive.campaign.figures.metrics.figure import PREFIX, Figure
from executive.errors import DataError
from executive.interfaces.metric import (
    Measurement,
    Metric,
    RunRecord,
    Share,
    TimedEvent,
    Values,
)
from executive.interfaces.report import CutOffReport, MissionReport
from executive.interfaces.report_file import read_report
from executive.journal import read_journal
from executive.mission.fault import place_of
from executive.mission.run_folder import RunFolder


def record_of(folder: Path) -> RunRecord:
    """Read what a run left behind in its folder.

    Raises:
        DataError: If there is no report, the run was cut off, or report or journal is damaged; it
            names the place.
    """
    run = RunFolder(folder)
    return RunRecord(_report(run.report), _events(run.journal))


def _report(path: Path) -> MissionReport:
    report = read_report(path)
    if isinstance(report, CutOffReport):
        raise DataError(f"{path}: the run was cut off: {report.reason}; nothing can be measured")
    return report


def _events(path: Path) -> tuple[TimedEvent, ...]:
    try:
        return tuple(TimedEvent(one.time_s, one.event, one.node) for one in read_journal(path))
    except FileNotFoundError as error:
        raise DataError(f"{path}: there is no journal beside the report") from error
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: not a journal: {error}") from error


def metric(name: str) -> Metric:
    """Return a metric by its installed name; `figure.NAME` is a figure that missions report.

    Raises:
        UnknownPluginError: If none of that name is installed; the message names the nearest.
        BrokenPluginError: If it cannot be imported, or is no metric.
    """
    if name.startswith(PREFIX):
        return Figure(name.removeprefix(PREFIX))
    found = registry.load(registry.METRICS, name)
    if not issubclass(found, Metric):
        raise registry.BrokenPluginError(
            f"metric '{name}': {found.__qualname__} does not derive from Metric"
        )
    return found()


def measure(record: RunRecord, names: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Measure a run with several metrics.

    Args:
        record: What the run left behind.
        names: Installed names of the metrics.

    Returns:
        For each metric that had something to measure `{"hits", "of"}` or `{"values"}`; for one that
        raised an error `{"problem": error with file:line}`. An error of a metric costs this run
        that one measurement only, and its traceback is logged.

    Raises:
        UnknownPluginError: If a metric is not installed.
        BrokenPluginError: If a metric cannot be imported.
    """
    measured: dict[str, dict[str, Any]] = {}
    for name, one in [(name, metric(name)) for name in names]:
        try:
            found = one.measure(record)
            if found is not None:
                measured[name] = _plain(found, one)
        except Exception as error:  # whatever a metric of another package raises
            measured[name] = {"problem": _told(error, one)}
            logging.getLogger(__name__).exception("metric '%s' raised an error", name)
    return measured


def _plain(found: Measurement, metric: Metric) -> dict[str, Any]:
    expected = Share if metric.is_share else Values
    if not isinstance(found, expected):
        raise TypeError(f"expected {expected.__name__}, got {type(found).__name__}")
    if isinstance(found, Values):
        if not all(math.isfinite(value) for value in found.values):
            raise ValueError(f"a value is not finite: {found.values}")
        return {"values": [float(value) for value in found.values]}
    if not 0 <= found.hits <= found.of:
        raise ValueError(f"{found.hits} hits of {found.of} are no share")
    return {"hits": int(found.hits), "of": int(found.of)}


def _told(error: Exception, metric: Metric) -> str:
    frames = list(traceback.walk_tb(error.__traceback__))
    place = place_of(frames, type(metric).__module__)
    return f"{type(error).__name__}: {error} ({place})"


def measurements_from(
    measured: Mapping[str, Any],
) -> tuple[dict[str, Measurement], dict[str, str]]:
    """Return what `measure` returned: the measurements, and the problems, by metric.

    Raises:
        DataError: If it is something else.
    """
    found: dict[str, Measurement] = {}
    problems: dict[str, str] = {}
    for name, one in measured.items():
        match one:
            case {"hits": int(hits), "of": int(of)}:
                found[name] = Share(hits, of)
            case {"values": list(values)}:
                found[name] = Values(tuple(float(value) for value in values))
            case {"problem": str(problem)}:
                problems[name] = problem
            case _:
                raise DataError(f"metric '{name}': {one!r} is no measurement")
    return found, problems
