"""Registration: lay one cloud over another without a guess."""

from abc import ABC, abstractmethod

import numpy as np

from executive.interfaces.plugin import Plugin
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


class Registrar(Plugin, ABC):
    """Find the transform that lays a source cloud over a target (Mascaro 2020, Sec. 4.4)."""

    capability = "registration"

    @abstractmethod
    def register(self, target: Cloud, source: Cloud, rng: "np.random.Generator") -> Alignment:
        """Lay a survey over the map, without a guess; the same generator state gives the same
        answer. It may be slow: a job.

        Args:
            target: The map, in the frame `map` [m].
            source: The survey in its own frame; its scale may be off by some per cent.
            rng: The only source of chance.

        Returns:
            The transform, accepted or refused with a reason; a wrong one accepted is the worst
            outcome. An empty cloud, or one without objects, is refused.
        """

    def find(self, target: Cloud, model: Cloud) -> Alignment:
        """Find one object, known all around, in a cloud with its ground, however it lies there;
        deterministic.

        Returns:
            T_target_model, accepted or refused with a reason. A method that needs several objects
            refuses.
        """
        return Alignment(
            np.eye(4), False, "this method registers maps, not single objects", 0.0, 0.0
        )
