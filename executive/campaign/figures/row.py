"""One run as statistics see it."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.interfaces.metric import Measurement


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
    """

    number: int
    seed: int
    levels: Mapping[str, str]
    has_answer: bool
    measurements: Mapping[str, Measurement]
