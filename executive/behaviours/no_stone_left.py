"""Ask whether there is still work."""

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import StoneState


class NoStoneLeft(Condition):
    """Succeed when no known stone is left on the ground: each is placed or set aside."""

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        stones = self.context.use(ObjectDatabase).stones()
        left = [stone.id for stone in stones if stone.state is StoneState.ON_GROUND]
        return failed(f"stones {left} are left") if left else succeeded()
