"""What a campaign and its fork server say to each other, one picklable value a message."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from executive.campaign.trial import Trial


@dataclass(frozen=True, slots=True)
class Begin:
    """Fork a process for a run.

    Attributes:
        run: Number of the run within its server.
        trial: What to run.
        folder: Folder of the run.
        inputs: Local path of each input by its name.
    """

    run: int
    trial: Trial
    folder: Path
    inputs: Mapping[str, Path]


@dataclass(frozen=True, slots=True)
class Begun:
    """The process of a run exists; its process group has the same number."""

    run: int
    pid: int


class Ended(Enum):
    """What the process of a run says of its end before it exits."""

    ANSWERED = "answered"  # the answer is in the folder
    RAISED = "raised"  # an exception
    REFUSED = "refused"  # a ConfigError: every run would end so
    DISK_FULL = "disk_full"  # neither the trial nor the work is to blame


@dataclass(frozen=True, slots=True)
class LastWord:
    """The end of a run as its own process saw it; a process that was killed says nothing."""

    ended: Ended
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Exited:
    """The process of a run has ended.

    Attributes:
        run: Number of the run.
        exit_code: Exit status, or minus the number of the signal that ended it.
        cpu_s: Processor time of the process and of its children that ended before it [s].
        peak_memory_bytes: Largest resident memory of the process [byte].
        last_word: What it said before it exited.
    """

    run: int
    exit_code: int
    cpu_s: float
    peak_memory_bytes: int
    last_word: LastWord | None
