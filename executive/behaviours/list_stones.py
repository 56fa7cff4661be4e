"""Write the known stones into the report."""

import numpy as np

from executive.events.finding import ListedStone, StonesListed
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import Stone


class ListStones(Condition):
    """Write every stone of the database into journal and report: state, place and extents.

    Fails when no stone is known.
    """

    needs = (ObjectDatabase,)

    def check(self) -> Outcome[None]:
        """List them, by id."""
        stones = self.context.use(ObjectDatabase).stones()
        self.context.record(StonesListed(tuple(map(_listed, stones))))
        if not stones:
            return failed("no stone is known")
        return succeeded(reason=f"{len(stones)} stones")


def _listed(stone: Stone) -> ListedStone:
    extents_m = np.ptp(stone.points_map, axis=0)
    return ListedStone(
        stone.id, stone.state.value, stone.centroid_map, extents_m, len(stone.points_map)
    )
