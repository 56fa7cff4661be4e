"""A monitor's report of trouble."""

from dataclasses import dataclass
from enum import StrEnum


class Trouble(StrEnum):
    """Kinds of trouble with a held stone (Mascaro 2020, Sec. 6.3)."""

    SLIP = "slip"
    DROP = "drop"
    EMPTY = "empty"  # the jaws closed on nothing


@dataclass(frozen=True, slots=True)
class Verdict:
    """Trouble that a monitor has recognised.

    Attributes:
        stamp_s: Time at which it was recognised [s].
        monitor: Name of the monitor.
        trouble: Kind of trouble.
        detail: The measured figures, in words.
    """

    stamp_s: float
    monitor: str
    trouble: Trouble
    detail: str
