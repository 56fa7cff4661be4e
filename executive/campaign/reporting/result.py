"""One finished run as reports show it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from executive.campaign.figures.row import Row, ending_of, row_of
from executive.campaign.trial import Outcome, Status, Trial
from executive.interfaces.metric import Measurement

SUCCESS = "success"


@dataclass(frozen=True, slots=True)
class Result:
    """What a trial asked for, what came of it, and what was measured.

    Attributes:
        trial: The trial.
        row: What statistics see of it.
        status: How its run ended.
        outcome: Outcome of the mission: `success`, `failure`, `stopped` or `fault`; empty for a
            run without an answer, and for work that is no mission.
        reason: Why the run has no answer, or why the mission ended as it did.
        wall_s: Duration of the run [s].
        cpu_s: Its processor time [s].
        peak_memory_bytes: Its largest resident memory [byte].
        tries: How often it was begun.
        worker: Where it ran.
    """

    trial: Trial
    row: Row
    status: Status
    outcome: str
    reason: str
    wall_s: float
    cpu_s: float
    peak_memory_bytes: int
    tries: int
    worker: str

    @property
    def has_answer(self) -> bool:
        """Return whether the run came to an end by itself."""
        return self.row.has_answer

    @property
    def has_failed(self) -> bool:
        """Return whether the run has no answer, or is a mission that did not succeed."""
        return not self.has_answer or self.outcome not in ("", SUCCESS)

    @property
    def measurements(self) -> Mapping[str, Measurement]:
        """Return what each metric measured."""
        return self.row.measurements


def results_of(trials: Iterable[Trial], outcomes: Iterable[Outcome]) -> Iterator[Result]:
    """Join trials and their outcomes by number, in the order of the outcomes.

    Raises:
        DataError: If measurements are damaged.
    """
    by_number = {trial.number: trial for trial in trials}
    for outcome in outcomes:
        yield _result(by_number[outcome.number], outcome)


def _result(trial: Trial, outcome: Outcome) -> Result:
    ending = ending_of(outcome)
    return Result(
        trial=trial,
        row=row_of(trial, outcome),
        status=outcome.status,
        outcome="" if ending is None else ending.outcome,
        reason=outcome.reason or ("" if ending is None else ending.reason or ""),
        wall_s=outcome.wall_s,
        cpu_s=outcome.cpu_s,
        peak_memory_bytes=outcome.peak_memory_bytes,
        tries=outcome.tries,
        worker=outcome.worker,
    )
