"""Driving: paths of the chassis over the ground, and how to steer along them."""

from abc import ABC, abstractmethod

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.drive import BasePath, DrivePlan, DriveRequest, Steering


class DrivePlanner(Plugin, ABC):
    """Plan ways of the chassis over ground that the map shows, and follow them."""

    capability = "driving"

    @abstractmethod
    def plan(self, request: DriveRequest) -> DrivePlan:
        """Plan a path from rest to rest; deterministic. It may be slow: a job.

        Returns:
            A path within the machine's limits that begins at the present pose and ends at one of
            the goals, or a refusal: what stands in the way, ground too steep, ground unseen.
        """

    @abstractmethod
    def steer(self, path: BasePath, along_m: float, T_map_base: Float) -> Steering:
        """Return how to drive on; fast, and called at each tick.

        The speed falls in time for the machine to stop at the path's end, and is 0 there.

        Args:
            path: The path that is being followed.
            along_m: How far along it the machine was at the last call [m]; 0 at the first.
            T_map_base: Estimated pose of the chassis, shape (4, 4).
        """
