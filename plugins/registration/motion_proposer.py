"""The interface of methods that propose candidate motions."""

from abc import ABC, abstractmethod

from executive_plugins.registration.stopwatch import Stopwatch

from executive.arrays import Float
from executive.messages.segment import Segmentation


class MotionProposer(ABC):
    """Proposes motions that may align a source with a target; `SegmentRegistrar` tests them."""

    @abstractmethod
    def propose(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> list[Float]:
        """Return T_target_source of candidates, each (4, 4), the likeliest first.

        Args:
            target: Segments of the target.
            source: Segments of the source.
            watch: Receives the time of each stage.
        """
