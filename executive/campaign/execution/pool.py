"""Where runs happen: processes of this computer, or workers of a cluster."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from executive.campaign.trial import Outcome, Trial
from executive.errors import ConfigError


@dataclass(frozen=True, slots=True)
class Lost:
    """A run that was begun and whose worker is gone; the trial is begun again.

    Attributes:
        number: The trial's number.
        reason: What is known of it, for a person.
    """

    number: int
    reason: str


class RefusedError(ConfigError):
    """A run's work refuses its arguments, such as a plugin that is not installed.

    Attributes:
        number: The trial's number; the pool has forgotten the run.
    """

    def __init__(self, number: int, reason: str) -> None:
        super().__init__(reason)
        self.number = number


class Pool(ABC):
    """Runs trials side by side. One thread uses a pool, that of the campaign."""

    @property
    @abstractmethod
    def slots(self) -> int:
        """Number of runs that it can take at present; it may change when workers come and go."""

    @abstractmethod
    def begin(self, trial: Trial, folder: Path, tries: int) -> None:
        """Begin a run; its files are in `folder` when it has ended.

        Args:
            trial: What to run.
            folder: A new folder for the run.
            tries: Which try of this trial it is, from 1.
        """

    @abstractmethod
    def wait(self, timeout_s: float) -> Sequence[Outcome | Lost]:
        """Return the runs that have ended since the last call; wait for one until the time is over.

        Raises:
            RefusedError: If a run's work refuses its arguments.
            ConfigError: If a worker cannot do this campaign's work at all: it lacks a plugin, or
                has another version of the package. No run counts as failed by that.
            DiskFullError: If a run found no space to write to. It does not count as failed either.
        """

    @abstractmethod
    def close(self) -> None:
        """End all runs that are still going on, and release workers."""
