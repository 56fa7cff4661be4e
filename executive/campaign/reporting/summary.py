"""The summary of a campaign: its figures and what they were made of, as `figures.json` holds them.

    {"schema": 1,
     "campaign": {"name", "description", "command", "versions", "digest", "begun": [...],
                  "seeds": [...], "factors": {factor: [levels]}, "metrics": {name: {"title",
                  "unit", "is_share", "is_more_better", "description"}},
                  "runs": {"asked", "done", "without_answer", "not_successful"}},
     "figures": {"estimates": [...], "differences": [...], "judgements": [...]}}

The entries of `figures` have the fields of the classes of the same name in
`executive/campaign/figures/figures.py`; what cannot be said (NaN there) is null.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from executive.campaign.description.campaign import Campaign
from executive.campaign.execution.ledger import Session
from executive.campaign.figures.figures import Figures
from executive.campaign.figures.measurement import metric
from executive.campaign.reporting.result import Result
from executive.errors import DataError
from executive.events.event import plain
from executive.interfaces.metric import Metric

_SCHEMA = 1


@dataclass(frozen=True, slots=True)
class MetricWords:
    """How a metric is shown; the fields are those of `executive.interfaces.metric.Metric`."""

    title: str
    unit: str
    is_share: bool
    is_more_better: bool
    description: str

    @classmethod
    def of(cls, metric: Metric) -> "MetricWords":
        """Return the words of a metric."""
        return cls(
            metric.title, metric.unit, metric.is_share, metric.is_more_better, metric.description
        )


@dataclass(frozen=True, slots=True)
class Runs:
    """How many runs were asked for, and what came of them.

    Attributes:
        asked: Number of trials of the campaign.
        done: Runs that came to an end by themselves.
        without_answer: Runs that crashed, were killed, or exceeded a limit.
        not_successful: Missions that came to an end without success.
    """

    asked: int
    done: int
    without_answer: int
    not_successful: int

    @property
    def missing(self) -> int:
        """Return how many trials have not ended."""
        return self.asked - self.done - self.without_answer


@dataclass(frozen=True, slots=True)
class Head:
    """What a campaign was: the head of its report.

    Attributes:
        name: The campaign's name.
        description: What it answers.
        command: The command line that made it.
        versions: Versions of this package that ran it: one, unless it was continued with another.
        begun: Date and time at which each session of it began, UTC, ISO 8601.
        digest: Hash over its trials.
        seeds: Its seeds, in ascending order.
        factors: Levels by factor.
        metrics: Words of the reported metrics by installed name, in order.
        runs: Numbers of runs.
    """

    name: str
    description: str
    command: str
    versions: tuple[str, ...]
    begun: tuple[str, ...]
    digest: str
    seeds: tuple[int, ...]
    factors: Mapping[str, tuple[str, ...]]
    metrics: Mapping[str, MetricWords]
    runs: Runs


@dataclass(frozen=True, slots=True)
class Summary:
    """The figures of a campaign and what they were made of."""

    campaign: Head
    figures: Figures


def head_of(
    campaign: Campaign, results: Sequence[Result], sessions: Sequence[Session], figures: Figures
) -> Head:
    """Return the head of a campaign's report."""
    named = (*campaign.metrics, *(one.metric for one in figures.estimates))
    answered = sum(result.has_answer for result in results)
    failed = sum(result.has_failed for result in results)
    without = len(results) - answered
    return Head(
        name=campaign.name,
        description=campaign.description,
        command=campaign.command,
        versions=tuple(dict.fromkeys(one.version for one in sessions)),
        begun=tuple(one.begun for one in sessions),
        digest=campaign.digest,
        seeds=tuple(sorted({trial.seed for trial in campaign.trials})),
        factors={name: tuple(levels) for name, levels in campaign.factors.items()},
        metrics={name: MetricWords.of(metric(name)) for name in dict.fromkeys(named)},
        runs=Runs(len(campaign.trials), answered, without, failed - without),
    )


def write_summary(path: Path, summary: Summary) -> None:
    """Write `figures.json`, whole or not at all."""
    partial = path.with_suffix(".partial")
    text = json.dumps(document_of(summary), indent=1, ensure_ascii=False)
    partial.write_text(text + "\n", encoding="utf-8")
    partial.replace(path)


def document_of(summary: Summary) -> dict[str, Any]:
    """Return the content of `figures.json`."""
    return {"schema": _SCHEMA, **without_nan(plain(summary))}


def read_summary(path: Path) -> Summary:
    """Read `figures.json` back.

    Raises:
        DataError: If the file is absent or is not a summary; it names the first wrong place.
    """
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise DataError(f"{path}: there is no such summary of a campaign") from error
    except (OSError, ValueError, RecursionError) as error:
        raise DataError(f"{path}: not a summary of a campaign: {error}") from error
    if not isinstance(found, dict) or found.pop("schema", None) != _SCHEMA:
        raise DataError(f"{path}: not a summary of a campaign of schema {_SCHEMA}")
    found["figures"] = _with_nan(found.get("figures"))
    try:
        return TypeAdapter(Summary).validate_python(found)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise DataError(f"{path}: {place}: {first['msg']}") from error


def without_nan(value: Any) -> Any:
    """Return plain values with null for what JSON has no number for."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, list):
        return [without_nan(one) for one in value]
    if isinstance(value, dict):
        return {key: without_nan(one) for key, one in value.items()}
    return value


def _with_nan(value: Any) -> Any:
    if value is None:
        return math.nan
    if isinstance(value, list):
        return [_with_nan(one) for one in value]
    if isinstance(value, dict):
        return {key: _with_nan(one) for key, one in value.items()}
    return value
