"""Smoothing: the trajectory of the machine from a whole recording."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence

from executive.interfaces.recorded_log import LogPlugin
from executive.messages.base_state import BaseState
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement


class TrajectorySmoother(LogPlugin, ABC):
    """Estimate a trajectory from all measurements of a recording at once."""

    capability = "smoothing"

    @abstractmethod
    def smooth(self, observations: Iterable[Observation | LidarIncrement]) -> Sequence[BaseState]:
        """Return the state at each inertial sample from the first known state on.

        The answer is empty if no state was ever found.

        Deterministic; it may take as long as the recording.

        Args:
            observations: In order of arrival; stamps may be older than those before.
        """
