"""Ask whether the mission placed anything."""

from collections import Counter

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
        counts = Counter(stone.state for stone in stones)
        if placed := counts[StoneState.PLACED]:
            return succeeded(reason=f"{placed} of {len(stones)} stones placed")
        if not stones:
            return failed("no stone is known, so none is placed")
        told = ", ".join(f"{n} {state.value.replace('_', ' ')}" for state, n in counts.items())
        return failed(f"none of {len(stones)} stones is placed: {told}")
