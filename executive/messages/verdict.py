"""What a monitor has to say."""

from dataclasses import dataclass
from enum import StrEnum


class Trouble(StrEnum):
    """Kinds of trouble with a held stone (Mascaro 2020, Sec. 6.3)."""

    SLIP = "slip"
    DROP = "drop"
    EMPTY = "empty"  # the jaws closed on nothing


@dataclass(frozen=True, slots=True)
class Verdict:
    """Trouble, as a monitor saw it.

    Attributes:
        stamp_s: When it was recognised [s].
        monitor: Name of the monitor.
        trouble: What it is.
        detail: The measured figures, in words.
    """

    stamp_s: float
    monitor: str
    trouble: Trouble
    detail: str
