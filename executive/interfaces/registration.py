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
    def register(self, target: Cloud, source: Cloud, rng: np.random.Generator) -> Alignment:
        """Return the transform, accepted or refused with a reason; a wrong one accepted is the
        worst outcome.
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
