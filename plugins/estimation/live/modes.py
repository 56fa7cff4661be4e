"""How the dual graph stands towards the satellites, and why."""

import logging
from dataclasses import dataclass
from enum import StrEnum

_log = logging.getLogger(__name__)


class Mode(StrEnum):
    """State of the estimator.

    GLOBAL: fixes correct the estimate. SUSPECT: none has lately, or one was refused.
    FALLBACK: lidar and inertia carry it. RECOVERING: fixes agree again with the odometry, but not
    for long.
    """

    GLOBAL = "GLOBAL"
    SUSPECT = "SUSPECT"
    FALLBACK = "FALLBACK"
    RECOVERING = "RECOVERING"


@dataclass(frozen=True, slots=True)
class ModeChange:
    """One change of the mode.

    Attributes:
        stamp_s: Time of the measurement, or of its absence, that caused it [s].
        before: The mode that ended.
        after: The mode that began.
        reason: In words.
    """

    stamp_s: float
    before: Mode
    after: Mode
    reason: str


class Modes:
    """The current mode and how it came about."""

    def __init__(self) -> None:
        self.current = Mode.GLOBAL
        self.changes: list[ModeChange] = []

    @property
    def is_fallen_back(self) -> bool:
        """Whether the estimate does without satellites."""
        return self.current in (Mode.FALLBACK, Mode.RECOVERING)

    def change(self, stamp_s: float, after: Mode, reason: str) -> None:
        """Change the mode, and log it; the mode that is, is no change."""
        if after == self.current:
            return
        self.changes.append(ModeChange(stamp_s, self.current, after, reason))
        _log.info("%.2f s: %s → %s: %s", stamp_s, self.current, after, reason)
        self.current = after
