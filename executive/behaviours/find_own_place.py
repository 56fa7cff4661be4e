"""Find the place at which a held stone lay, to put it back there."""

import numpy as np

from executive.geometry.pose import inverse
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.resting import moved
from executive.leaf.slots_found import SlotList, tell_slots
from executive.messages.placement import Slot

_GRASP = "grasp"  # of events, with the pose in which the stone lay


class FindOwnPlace(Condition):
    """Find the slot in which a held stone lay when the jaws closed on it.

    It is free and in reach, and the stone has rested there. Fails for a stone that was never
    grasped.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self, stone: int) -> Outcome[SlotList]:
        """Look the place up.

        Args:
            stone: Id of the stone.
        """
        objects = self.context.use(ObjectDatabase)
        lay = [one.T_map_object for one in objects.history(stone) if one.kind == _GRASP]
        if not lay:
            return failed(f"stone {stone} has no place of its own: it was never grasped")
        known = objects.stone(stone)
        lying = moved(known, lay[-1] @ inverse(known.T_map_object))
        foot = np.array([*lying.centroid_map[:2], lying.points_map[:, 2].min()])
        return succeeded(SlotList(list(tell_slots(self.context, [Slot(1, foot)]))))
