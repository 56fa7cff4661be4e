"""Ask whether the mission placed anything."""

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import StoneState


class SomeStonePlaced(Condition):
    """Succeed if at least one stone is in a slot."""

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        stones = self.context.use(ObjectDatabase).stones()
        placed = [stone.id for stone in stones if stone.state is StoneState.PLACED]
        if not placed:
            return failed(f"none of {len(stones)} stones could be placed: all were set aside")
        return succeeded(reason=f"{len(placed)} of {len(stones)} stones placed")
