"""A trial: one run that a campaign asks for, and what came of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any


@dataclass(frozen=True, slots=True)
class Limits:
    """What a run may take; beyond it the run is ended and counts as failed.

    Attributes:
        time_s: Wall time [s].
        memory_bytes: Resident memory of its processes together [byte].
    """

    time_s: float
    memory_bytes: int


@dataclass(frozen=True, slots=True)
class Trial:
    """One run that a campaign asks for.

    Attributes:
        number: Position in the campaign, from 0.
        work: Kind of work by its installed name: `mission`, or that of another package.
        arguments: What the work is given, as JSON holds it.
        seed: Seed of all its random numbers.
        levels: The level of each factor by the factor's name. Trials that differ in one
            factor alone, with one seed, are a pair.
        limits: What the run may take.
    """

    number: int
    work: str
    arguments: Mapping[str, Any]
    seed: int
    levels: Mapping[str, str]
    limits: Limits


class Status(Enum):
    """How the run of a trial ended; only `DONE` has an answer, and all others count as failed."""

    DONE = "done"
    CRASHED = "crashed"  # an exception, an exit, or a signal such as a segmentation fault
    KILLED = "killed"  # by signal 9: by a person, or by the system for lack of memory
    TIMED_OUT = "timed_out"
    OUT_OF_MEMORY = "out_of_memory"  # beyond the campaign's own limit


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of a trial.

    Attributes:
        number: The trial's number.
        status: How its run ended.
        reason: Why, for a person; empty where it is done.
        answer: What the work returned; empty unless it is done.
        wall_s: Duration of the run with its overhead [s].
        cpu_s: Processor time of the run [s].
        peak_memory_bytes: Largest resident memory [byte].
        tries: How often a run of this trial was begun, lost workers included.
        worker: Where it ran: host and process.
    """

    number: int
    status: Status
    reason: str = ""
    answer: Mapping[str, Any] = field(default_factory=dict)
    wall_s: float = 0.0
    cpu_s: float = 0.0
    peak_memory_bytes: int = 0
    tries: int = 1
    worker: str = ""
