"""Modes of the dual graph with respect to satellite fixes, and their changes."""

import logging
from dataclasses import dataclass
from enum import StrEnum

_log = logging.getLogger(__name__)


class Mode(StrEnum):
    """Mode of the estimator.

    GLOBAL: fixes correct the estimate. SUSPECT: no fix came lately, or one was refused.
    FALLBACK: the estimate relies on lidar and inertial sensor. RECOVERING: fixes agree again with
    the odometry, but not yet for long enough.
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
        reason: The cause, in words.
    """

    stamp_s: float
    before: Mode
    after: Mode
    reason: str


class Modes:
    """The current mode and the changes that led to it."""

    def __init__(self) -> None:
        self.current = Mode.GLOBAL
        self.changes: list[ModeChange] = []

    @property
    def is_fallen_back(self) -> bool:
        """Whether the estimate is computed without fixes."""
        return self.current in (Mode.FALLBACK, Mode.RECOVERING)

    def change(self, stamp_s: float, after: Mode, reason: str) -> None:
        """Change the mode and log the change; do nothing if the mode is the current one."""
        if after == self.current:
            return
        self.changes.append(ModeChange(stamp_s, self.current, after, reason))
        _log.info("%.2f s: %s → %s: %s", stamp_s, self.current, after, reason)
        self.current = after
