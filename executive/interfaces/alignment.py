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
        """Move the source onto the target from a guess; deterministic. It may be slow: a job.

        Args:
            target: The cloud that stays; its frame is the target's.
            source: The cloud that is moved, in a frame of its own.
            T_target_source: The guess, read-only, shape (4, 4).
            max_distance_m: Largest distance of a correspondence [m], above 0.

        Returns:
            The transform, accepted or refused with a reason; refused where a cloud is empty or the
            clouds do not overlap. Its scale is 1.

        Raises:
            DataError: If the guess is not finite or of another shape, or the distance not positive.
        """
