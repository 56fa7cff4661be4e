"""Metrics: what is measured on one run, from what the run leaves behind."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from executive.events.event import Event
from executive.interfaces.report import MissionReport


@dataclass(frozen=True, slots=True)
class TimedEvent:
    """An event of the journal.

    Attributes:
        time_s: The mission's time [s].
        event: What happened.
        node: Path of the node that recorded it; empty for the mission itself.
    """

    time_s: float
    event: Event
    node: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class RunRecord:
    """What one run left behind.

    Attributes:
        report: Its report; `truth` is None after a run on a real machine.
        events: The journal in order.
    """

    report: MissionReport
    events: Sequence[TimedEvent] = field(default=())


@dataclass(frozen=True, slots=True)
class Share:
    """A count out of a number of trials within one run, such as stones placed out of stones."""

    hits: int
    of: int


@dataclass(frozen=True, slots=True)
class Values:
    """Measured values of one run, such as the error of each placed stone; may be empty."""

    values: tuple[float, ...]


Measurement = Share | Values


class Metric(ABC):
    """One metric; a package brings its own in the entry-point group `executive.metric.v1`.

    Attributes:
        title: What is measured, in a few words.
        unit: Unit of the values, such as `m`; empty for shares and counts.
        is_more_better: Whether a larger share or value is the better one.
        is_share: Whether `measure` returns shares; else it returns values. A run without a
            result (crash, time limit) counts as the worst in every share, which is no hit where
            more is better, and has no values.
        description: The definition, in one or two sentences.
    """

    title: ClassVar[str]
    unit: ClassVar[str] = ""
    is_more_better: ClassVar[bool] = True
    is_share: ClassVar[bool] = False
    description: ClassVar[str] = ""

    @abstractmethod
    def measure(self, run: RunRecord) -> Measurement | None:
        """Measure one run; None if the run holds nothing to measure it on."""
