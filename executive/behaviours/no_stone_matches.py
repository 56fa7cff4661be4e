"""Test that no stone meets some criteria."""

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.stone_filter import StoneFilter, matching_stones, words_of


class NoStoneMatches(Condition[StoneFilter]):
    """Succeed when no known stone meets all criteria.

    It asks what the database knows: scan and segment before, where a stone may have moved.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        found = matching_stones(self.context, self.settings)
        if found:
            ids = [stone.id for stone in found]
            return failed(f"stones {ids} match: {words_of(self.settings)}")
        return succeeded(reason=f"none matches: {words_of(self.settings)}")
