"""Segmentation: a cloud to the objects on its ground."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from executive.interfaces.plugin import Plugin
from executive.messages.cloud import Cloud
from executive.messages.segment import Segmentation


class Segmenter(Plugin, ABC):
    """Find object-like parts of a cloud (Mascaro 2020, Sec. 4.3)."""

    capability = "segmentation"

    @abstractmethod
    def segment(self, cloud: Cloud) -> Segmentation:
        """Split a cloud into its ground and the objects on it; deterministic.

        Gravity need not be along z to the degree: the ground's normal is within 30° of the frame's
        z axis. Segments are points of the cloud, in its frame, the one of most points first. It may
        be slow: a job.

        Raises:
            DataError: If the cloud is empty or shows no ground.
        """

    @abstractmethod
    def merge(self, clouds: Sequence[Cloud]) -> Cloud:
        """Merge clouds of one site, such as the machine's map and a survey, at one density.

        Segments are found from the density of their points, so overlapping clouds are thinned to
        the density that `segment` expects.

        Args:
            clouds: At least one, all in the same frame.

        Raises:
            DataError: If there is no cloud, or the clouds are in different frames.
        """
