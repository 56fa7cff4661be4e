"""The smoother's answer, a plain value that crosses the border between processes."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive_plugins.estimation.inertial.state import InertialState
from executive_plugins.estimation.live.modes import Mode, ModeChange

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """What one update gives.

    Attributes:
        state: At the newest measurement.
        covariance: Of its error, shape (15, 15).
        mode: How the estimator stands.
        changes: Changes of the mode since the last update.
        refused: Number of measurements refused since the last update, by stream and reason.
    """

    state: InertialState
    covariance: Float
    mode: Mode
    changes: tuple[ModeChange, ...]
    refused: Mapping[str, int]
