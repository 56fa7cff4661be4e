"""List stones by criteria."""

from dataclasses import dataclass

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, succeeded
from executive.leaf.stone_filter import OrderedStones, ordered_stones
from executive.messages.stone import Stone


@dataclass(frozen=True, slots=True)
class StonesMatching:
    """The stones that match, in order.

    Attributes:
        matching: Their ids.
        matching_stones: The stones as they are known now.
    """

    matching: list[int]
    matching_stones: list[Stone]


class StonesThatMatch(Condition[OrderedStones]):
    """List the stones that meet all criteria, in order; the list may be empty."""

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[StonesMatching]:
        found = ordered_stones(self.context, self.settings)
        ids = [stone.id for stone in found]
        return succeeded(StonesMatching(ids, found), f"{len(ids)} stones match: {ids}")
