"""One finished run as reports show it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from executive.campaign.trial import Outcome, Status, Trial
from executive.interfaces.metric import Measurement, Share, Values

SUCCESS = "success"


@dataclass(frozen=True, slots=True)
class Result:
    """What a trial asked for, what came of it, and what was measured.

    Attributes:
        trial: The trial.
        status: How its run ended.
        outcome: Outcome of the mission: `success`, `failure`, `stopped` or `fault`; empty for a
            run without an answer, and for work that is no mission.
        reason: Why the run has no answer, or why the mission ended as it did.
        wall_s: Duration of the run [s].
        cpu_s: Its processor time [s].
        peak_memory_bytes: Its largest resident memory [byte].
        tries: How often it was begun.
        worker: Where it ran.
        measurements: What each metric measured, by the metric's installed name.
        problems: Why a metric could not be measured, by its name.
    """

    trial: Trial
    status: Status
    outcome: str
    reason: str
    wall_s: float
    cpu_s: float
    peak_memory_bytes: int
    tries: int
    worker: str
    measurements: Mapping[str, Measurement]
    problems: Mapping[str, str]

    @property
    def has_answer(self) -> bool:
        """Return whether the run came to an end by itself."""
        return self.status is Status.DONE

    @property
    def has_failed(self) -> bool:
        """Return whether the run has no answer, or is a mission that did not succeed."""
        return not self.has_answer or self.outcome not in ("", SUCCESS)


def results_of(trials: Iterable[Trial], outcomes: Iterable[Outcome]) -> Iterator[Result]:
    """Join trials and their outcomes by number, in the order of the outcomes."""
    by_number = {trial.number: trial for trial in trials}
    for outcome in outcomes:
        yield _result(by_number[outcome.number], outcome)


def _result(trial: Trial, outcome: Outcome) -> Result:
    report = outcome.answer.get("report") or {}
    measured = outcome.answer.get("measurements") or {}
    return Result(
        trial=trial,
        status=outcome.status,
        outcome=str(report.get("outcome", "")),
        reason=outcome.reason or str(report.get("reason") or ""),
        wall_s=outcome.wall_s,
        cpu_s=outcome.cpu_s,
        peak_memory_bytes=outcome.peak_memory_bytes,
        tries=outcome.tries,
        worker=outcome.worker,
        measurements={n: _measurement(m) for n, m in measured.items() if "problem" not in m},
        problems={n: str(m["problem"]) for n, m in measured.items() if "problem" in m},
    )


def _measurement(measured: Mapping[str, Any]) -> Measurement:
    if "values" in measured:
        return Values(tuple(measured["values"]))
    return Share(measured["hits"], measured["of"])
