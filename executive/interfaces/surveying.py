"""Surveying: a cloud of the site from elsewhere, such as a drone."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping

import numpy as np

from executive.interfaces.plugin import Plugin
from executive.messages.cloud import Cloud


class Survey(Plugin, ABC):
    """Give a cloud of the site in a frame of its own, its pose unknown, its scale rough (Mascaro
    2020, Sec. 4.1).
    """

    capability = "surveying"

    @abstractmethod
    def survey(self, rng: "np.random.Generator") -> Cloud:
        """Return the site as seen from outside.

        Raises:
            DataError: If there is no usable survey; the message names the file and the cure.
        """

    def follow(self, tell: Callable[[str], None]) -> None:
        """Hand progress to a function, a line a step, from now on.

        A survey that takes no time says nothing.
        """

    def account(self) -> Mapping[str, float | tuple[str, ...]]:
        """Return figures on the last survey for its report, with units in their names; empty if
        the plugin has none.
        """
        return {}
