"""The result of the smoother, a plain value that can be sent between processes."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive_plugins.estimation.inertial.state import InertialState
from executive_plugins.estimation.live.modes import Mode, ModeChange

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """The result of one update of the smoother.

    Attributes:
        state: State at the newest measurement.
        covariance: Covariance of its error, shape (15, 15).
        mode: Mode of the estimator.
        changes: Changes of the mode since the last update.
        refused: Number of measurements refused since the last update, by stream and reason.
    """

    state: InertialState
    covariance: Float
    mode: Mode
    changes: tuple[ModeChange, ...]
    refused: Mapping[str, int]
