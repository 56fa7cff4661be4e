"""Write the known stones into the report."""

import numpy as np

from executive.errors import DataError
from executive.events.finding import ListedStone, StonesListed
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import Stone


class ListStones(Condition):
    """Write every stone of the database into journal and report: state, place, extents and volume.

    Fails when no stone is known.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        """List them, by id."""
        stones = self.context.use(ObjectDatabase).stones()
        self.context.record(StonesListed(tuple(map(_listed, stones))))
        if not stones:
            return failed("no stone is known")
        return succeeded(reason=f"{len(stones)} stones")


def _listed(stone: Stone) -> ListedStone:
    return ListedStone(
        id=stone.id,
        state=stone.state.value,
        centroid_map=stone.centroid_map,
        extents_m=np.ptp(stone.points_map, axis=0),
        points=len(stone.points_map),
        volume_m3=_volume_m3(stone),
    )


def _volume_m3(stone: Stone) -> float | None:
    try:
        return stone.volume_m3
    except DataError:  # its known surface spans no volume
        return None
