"""Calibration: mounting, clocks and noise of sensors from a recording."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.arrays import Float
from executive.interfaces.recorded_log import LogPlugin
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """One property of one sensor, as a recording shows it.

    Attributes:
        sensor: Name of the sensor's frame.
        name: What it is, by the name of the field in a calibration file: `stamp_late_s` (stamps
            minus times of measurement), `xyz_m` and `rpy_rad` (in the link that carries it),
            `covariance_scale` (factor on declared covariances), `rate_hz`, or a noise of an
            inertial sensor's description.
        value: The components, shape (k,).
        std: Their standard deviations, shape (k,).
        declared: What was declared before, shape (k,).
        is_found: Which components are as certain as they must be, shape (k,).
        advice: What a recording must hold for the others to be found; empty if all are.
    """

    sensor: str
    name: str
    value: Float
    std: Float
    declared: Float
    is_found: NDArray[np.bool_]
    advice: str = ""


class Calibrator(LogPlugin, ABC):
    """Find mounting, clocks and noise of the sensors on one body from a whole recording."""

    capability = "calibration"

    @abstractmethod
    def calibrate(self, observations: Iterable[Observation | LidarIncrement]) -> Sequence[Quantity]:
        """Return what the recording shows of each sensor, with its uncertainty.

        Deterministic; it may take as long as the recording.

        Args:
            observations: In order of arrival; stamps may be older than those before.

        Raises:
            DataError: If the recording shows no motion at all that could be solved for; the
                message says what is missing.
        """
