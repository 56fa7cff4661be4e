"""Reading and writing `report.json`, the report in the folder of a run."""

import json
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path

from executive.errors import DataError
from executive.events.event import read_record
from executive.interfaces.report import CutOffReport, MissionEnding, MissionReport

REPORT = "report.json"


def write_report(path: Path, report: MissionReport) -> None:
    """Write a report as JSON, whole or not at all."""
    partial = path.with_suffix(".partial")
    partial.write_text(
        json.dumps(report.payload(), indent=2, ensure_ascii=False) + "\n", encoding="utf-8"
    )
    partial.replace(path)


def read_report(path: Path) -> MissionReport | CutOffReport:
    """Read the report of a run, or the short one of a run that was cut off.

    Raises:
        DataError: If there is none, or it is not one that this version has written; the message
            names the file, the field and what helps.
    """
    found = _read(path)
    is_short = isinstance(found, dict) and found.keys() == {
        one.name for one in fields(CutOffReport)
    }
    try:
        if is_short:
            return read_record(CutOffReport, found, "the report")
        return read_record(MissionReport, found, "the report")
    except DataError as error:
        raise DataError(
            f"{path}: not a report of this version of the executive: {error}; read it with the"
            " version that wrote it, or run the mission again"
        ) from error


def read_ending(path: Path) -> MissionEnding:
    """Read from a report of any version how the run ended.

    Raises:
        DataError: If there is no report, or it does not tell.
    """
    found = _read(path)
    try:
        return ending_in(found)
    except DataError as error:
        raise DataError(f"{path}: {error}") from error


def ending_in(report: object) -> MissionEnding:
    """Return how a run ended, from what JSON holds of a report of any version.

    Raises:
        DataError: If it does not tell.
    """
    if isinstance(report, Mapping):
        names = [one.name for one in fields(MissionEnding)]
        report = {name: report[name] for name in names if name in report}
    return read_record(MissionEnding, report, "the report")


def _read(path: Path) -> object:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise DataError(
            f"{path}: there is no report: the run goes on, or was killed and can be resumed"
            " (`executive resume`)"
        ) from error
    except (OSError, ValueError, RecursionError) as error:
        raise DataError(
            f"{path}: not a report of a run: {error}; the journal beside it holds what happened"
            " (`executive journal`)"
        ) from error
