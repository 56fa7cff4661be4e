"""Choose a stone by criteria."""

from dataclasses import dataclass

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.stone_filter import OrderedStones, ordered_stones, words_of
from executive.messages.stone import Stone


@dataclass(frozen=True, slots=True)
class StoneChosen:
    """The first of the stones that match.

    Attributes:
        stone: Its id.
        chosen: The stone as it is known now, for expressions on its size, mass and place.
    """

    stone: int
    chosen: Stone


class SelectStone(Condition[OrderedStones]):
    """Choose the first stone that meets all criteria; fail when none does."""

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[StoneChosen]:
        found = ordered_stones(self.context, self.settings)
        if not found:
            return failed(f"no stone matches: {words_of(self.settings)}")
        first = found[0]
        told = f"stone {first.id}, {first.volume_m3:.2f} m³, {first.length_m:.2f} m long"
        return succeeded(StoneChosen(first.id, first), f"{told}; {len(found)} match")
