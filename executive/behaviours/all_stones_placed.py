"""Ask whether the mission placed everything."""

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import StoneState


class AllStonesPlaced(Condition):
    """Succeed if every known stone is in a slot; otherwise tell which are not, by their states."""

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        stones = self.context.use(ObjectDatabase).stones()
        if not stones:
            return failed("no stone is known, so none is placed")
        others: dict[StoneState, list[int]] = {}
        for stone in stones:
            if stone.state is not StoneState.PLACED:
                others.setdefault(stone.state, []).append(stone.id)
        placed = len(stones) - sum(map(len, others.values()))
        told = f"{placed} of {len(stones)} stones placed"
        if not others:
            return succeeded(reason=told)
        left = "; ".join(
            f"{state.value.replace('_', ' ')}: {', '.join(map(str, ids))}"
            for state, ids in others.items()
        )
        return failed(f"{told}; {left}")
