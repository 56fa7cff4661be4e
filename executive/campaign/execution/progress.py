"""How far a campaign is."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.campaign.trial import Outcome, Status


@dataclass(frozen=True, slots=True)
class RunningTrial:
    """A run that goes on: its trial's number, and for how long [s]."""

    number: int
    for_s: float


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a campaign is.

    Attributes:
        total: Number of trials.
        counts: Number of finished trials by status, those of earlier sessions included.
        running: The runs that go on.
        left_s: Estimated time to the end [s]; None before the first run of this session has ended.
        stopped_by: Name of the signal by which a person stopped it; empty if none did.
        resumed: Number of trials that were finished when this session began.
        ended: What came of the runs that have ended since the last report of progress.
    """

    total: int
    counts: Mapping[Status, int]
    running: tuple[RunningTrial, ...]
    left_s: float | None
    stopped_by: str = ""
    resumed: int = 0
    ended: tuple[Outcome, ...] = ()

    @property
    def finished(self) -> int:
        """Number of finished trials."""
        return sum(self.counts.values())

    @property
    def is_complete(self) -> bool:
        """Whether every trial has an outcome."""
        return self.finished == self.total
