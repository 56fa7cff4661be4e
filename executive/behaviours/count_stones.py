"""Count the known stones."""

from dataclasses import dataclass

from pydantic import Field

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.stone_filter import StoneFilter, matching_stones
from executive.messages.stone import StoneState


class CountStonesSettings(StoneFilter):
    states: tuple[StoneState, ...] = Field(
        (StoneState.ON_GROUND, StoneState.PLACED, StoneState.SET_ASIDE),
        min_length=1,
        description="States that count; by default every stone that lies somewhere.",
    )
    at_least: int = Field(0, ge=0, description="Fewer stones than this are a failure.")


@dataclass(frozen=True, slots=True)
class StoneCount:
    """How many stones there are.

    Attributes:
        count: Number of stones that match.
    """

    count: int


class CountStones(Condition[CountStonesSettings]):
    """Count the stones of the database that meet all criteria."""

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[StoneCount]:
        """Count them."""
        count = len(matching_stones(self.context, self.settings))
        if count < self.settings.at_least:
            wanted = self.settings.at_least
            return failed(f"{count} stones, and {wanted} are wanted", StoneCount(count))
        return succeeded(StoneCount(count), f"{count} stones")
