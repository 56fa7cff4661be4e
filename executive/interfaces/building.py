"""Building: the next stone of a structure, and the pose in which it is to rest there."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np

from executive.interfaces.plugin import Plugin
from executive.messages.building import AsBuilt, BuildPlan
from executive.messages.solid_stone import SolidStone

# Asked between two steps of a search: False ends it at its best answer so far, because the time
# that it was given is over, or because it was cancelled.
MayGoOn = Callable[[], bool]


class StructurePlanner(Plugin, ABC):
    """Propose where the next stone of a structure goes: on the ground, or on stones that stand."""

    capability = "building"

    @abstractmethod
    def propose(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn = lambda: True,
    ) -> BuildPlan:
        """Return targets for one stone of the inventory, best first, or the reason for none.

        Pure, and the same for the same state of the generator, unless `may_go_on` cuts it short.
        It may be slow: a job. Neither the stones that stand nor the inventory are changed: the
        caller places the stone, measures where it came to rest, and asks again.

        Args:
            built: The structure, its ground, and the stones that stand, where they were measured.
            inventory: Stones that may be used; names are unique.
            rng: The only source of chance.
            may_go_on: Asked often; after False the best answer so far is returned.

        Raises:
            DataError: If two stones of the inventory have one name, or a stone that stands is out
                of any relation to the ground.
        """
