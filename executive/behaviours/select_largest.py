"""Choose the next stone."""

from dataclasses import dataclass

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import StoneState


@dataclass(frozen=True, slots=True)
class StoneSelected:
    """The stone to move next.

    Attributes:
        stone: Id of the stone.
    """

    stone: int


class SelectLargest(Condition):
    """Choose the stone of most points that lies on the ground; fail when none is left.

    Source: Mascaro et al. 2020, Sec. 5.1.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[StoneSelected]:
        stones = self.context.use(ObjectDatabase).stones()
        left = [stone for stone in stones if stone.state is StoneState.ON_GROUND]
        if not left:
            return failed("no stone is left on the ground")
        largest = max(left, key=lambda stone: (len(stone.points_map), -stone.id))
        return succeeded(StoneSelected(largest.id), f"stone {largest.id}")
