"""One way to propose motions, to be tried until one passes the gate."""

from abc import ABC, abstractmethod

from executive_plugins.registration.stopwatch import Stopwatch

from executive.arrays import Float
from executive.messages.segment import Segmentation


class MotionProposer(ABC):
    """Propose motions that may lay a source over a target; never decide."""

    @abstractmethod
    def propose(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> list[Float]:
        """Return T_target_source of candidates, each (4, 4), the likeliest first;
        times its stages.
        """
