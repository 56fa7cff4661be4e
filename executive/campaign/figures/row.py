"""One run as statistics see it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from executive.campaign.figures.measurement import measurements_from
from executive.campaign.trial import Outcome, Status, Trial
from executive.interfaces.metric import Measurement
from executive.interfaces.report import MissionEnding
from executive.interfaces.report_file import ending_in


@dataclass(frozen=True, slots=True)
class Row:
    """One finished trial.

    Attributes:
        number: The trial's number.
        seed: Its seed: the site, which pairs the trials of different levels.
        levels: The level of each factor.
        has_answer: Whether the run came to an end by itself; one that crashed, was killed or
            exceeded a limit did not, and counts as failed.
        measurements: What each metric measured, by the metric's installed name; a metric that had
            nothing to measure is absent.
        is_faulted: Whether an error of a plugin or a leaf ended the mission. A share that it could
            not measure counts as in a run without an answer.
        problems: Why a metric could not be measured, by its name: the error with `file:line`.
    """

    number: int
    seed: int
    levels: Mapping[str, str]
    has_answer: bool
    measurements: Mapping[str, Measurement]
    is_faulted: bool = False
    problems: Mapping[str, str] = field(default_factory=dict)


def row_of(trial: Trial, outcome: Outcome) -> Row:
    """Return the row of a trial of the work `mission`, from its outcome in the ledger.

    Raises:
        DataError: If the answer's measurements are not what `measure` returns, or its report does
            not tell how the mission ended.
    """
    answer, ending = outcome.answer, ending_of(outcome)
    measurements, problems = measurements_from(answer.get("measurements", {}))
    return Row(
        number=trial.number,
        seed=trial.seed,
        levels=trial.levels,
        has_answer=outcome.status is Status.DONE,
        measurements=measurements,
        is_faulted=ending is not None and ending.outcome == "fault",
        problems=problems,
    )


def ending_of(outcome: Outcome) -> MissionEnding | None:
    """Return how a trial's mission ended; None without an answer, and of work that is no mission.

    Raises:
        DataError: If the report in its answer does not tell.
    """
    report = outcome.answer.get("report")
    return None if report is None else ending_in(report)
