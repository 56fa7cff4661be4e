"""Smoothing of a whole recording: where the machine was, once everything is measured."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence

from executive.interfaces.plugin import Plugin
from executive.messages.base_state import BaseState
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement


class TrajectorySmoother(Plugin, ABC):
    """Estimate a trajectory from all measurements at once, those after a time as well as those
    before it.
    """

    capability = "smoothing"

    @abstractmethod
    def smooth(self, observations: Iterable[Observation | LidarIncrement]) -> Sequence[BaseState]:
        """Return the state at each inertial sample, from the first that is known; empty if none
        ever is.

        Args:
            observations: In order of arrival.
        """
