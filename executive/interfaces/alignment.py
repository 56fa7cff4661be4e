"""Alignment: lay one cloud over another from a good guess."""

from abc import ABC, abstractmethod

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


class Aligner(Plugin, ABC):
    """Refine a transform locally (Mascaro 2020, Sec. 4.4 step 5 and Sec. 4.5)."""

    capability = "alignment"

    @abstractmethod
    def align(
        self, target: Cloud, source: Cloud, T_target_source: Float, max_distance_m: float
    ) -> Alignment:
        """Move the source onto the target, from a guess, with correspondences up to a distance [m];
        deterministic.
        """
