"""One run as its folder holds it; what is damaged or absent is told, and the rest is read."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from executive import registry
from executive.campaign.figures.measurement import measure, metric
from executive.campaign.reporting.summary import MetricWords
from executive.errors import ConfigError, DataError
from executive.interfaces.metric import RunRecord, TimedEvent
from executive.interfaces.report import CutOffReport, MissionReport
from executive.interfaces.report_file import REPORT, read_report
from executive.journal import Entry, JournalFile
from executive.mission.run_folder import RunFolder
from executive.plain_yaml import read_plain_yaml


@dataclass(frozen=True)
class ReadRun:
    """What of a run could be read.

    Attributes:
        folder: Its folder.
        report: Its report; the short one if it was cut off, None if there is none to read.
        entries: The lines of its journal, up to the first damaged one.
        mission: Its resolved mission file as plain values; empty if there is none.
        damages: What could not be read, each with its place.
    """

    folder: Path
    report: MissionReport | CutOffReport | None
    entries: Sequence[Entry]
    mission: Mapping[str, Any]
    damages: tuple[str, ...]

    @property
    def whole(self) -> MissionReport | None:
        """Return the report of a run that has written it itself; None of any other."""
        return self.report if isinstance(self.report, MissionReport) else None

    @property
    def command(self) -> str:
        """Return the command that repeats the run; empty without its mission or its seed."""
        if not self.mission or self.whole is None:
            return ""
        mission = RunFolder(self.folder).mission
        return f"executive run {shlex.quote(str(mission))} --seed {self.whole.seed}"

    @cached_property
    def measurements(self) -> Mapping[str, Mapping[str, Any]]:
        """Return what every installed metric measures, as `measure` says it."""
        if self.whole is None:
            return {}
        events = tuple(TimedEvent(one.time_s, one.event, one.node) for one in self.entries)
        record = RunRecord(self.whole, events)
        found: dict[str, Mapping[str, Any]] = {}
        for one in registry.installed(registry.METRICS):
            try:
                found |= measure(record, (one.name,))
            except registry.BrokenPluginError as error:
                found[one.name] = {"problem": str(error)}
        return found


def read_run(folder: Path) -> ReadRun:
    """Read the folder of a run.

    Raises:
        ConfigError: If it is no folder of a run, or the run was dry.
    """
    run = RunFolder(folder)
    if run.dry_note.is_file():
        raise ConfigError(
            f"{folder} holds a dry run: its leaves were mocked, so that there is nothing to report "
            f"or to compare; `executive coverage {folder}` tells which branches it has taken, and "
            f"`executive journal {folder}` what happened"
        )
    damages: list[str] = []
    if not (run.report.is_file() or run.journal.is_file()):
        told = f"is no folder of a run: it holds neither {REPORT} nor journal.jsonl"
        raise ConfigError(f"{folder} {told if folder.is_dir() else 'is no folder'}")
    report = _report(run.report, damages)
    entries = _entries(run.journal, damages)
    mission = _mission(run.mission, damages)
    return ReadRun(folder, report, entries, mission, tuple(damages))


def words_of(name: str) -> MetricWords:
    """Return a metric's words; of one that cannot be imported, its name."""
    try:
        return MetricWords.of(metric(name))
    except ConfigError as error:
        return MetricWords(name, "", False, True, str(error))


def _report(path: Path, damages: list[str]) -> MissionReport | CutOffReport | None:
    try:
        return read_report(path)
    except DataError as error:
        damages.append(str(error))
        return None


def _entries(path: Path, damages: list[str]) -> list[Entry]:
    entries: list[Entry] = []
    journal = JournalFile(path)
    try:
        entries.extend(journal.entries())  # keeps what was read before an error
    except FileNotFoundError:
        damages.append(f"{path}: there is no journal")
    except DataError as error:
        damages.append(f"{error}; the {len(entries)} lines before it are read")
    except (OSError, UnicodeDecodeError) as error:
        damages.append(f"{path}: not a journal: {error}")
    if journal.cut_off:
        damages.append(f"{path}: its last line was cut off after {journal.cut_off} bytes")
    return entries


def _mission(path: Path, damages: list[str]) -> Mapping[str, Any]:
    try:
        found = read_plain_yaml(path)
    except ConfigError as error:
        damages.append(" ".join(str(error).split()))
    else:
        if isinstance(found, dict):
            return found
        damages.append(f"{path}: not a mission file: it holds no mapping")
    return {}
