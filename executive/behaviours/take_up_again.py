"""Give stones that were set aside another chance."""

from typing import Any

from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.stone import Stone, StoneState


class TakeUpAgain(Condition):
    """Make stones movable again that were set aside before others were placed; fail if there is
    none.

    What stood in their way may be gone. Where nothing has moved since, another try would end as the
    last one did.
    """

    needs = ("objects",)

    def check(self, **inputs: Any) -> Outcome:
        objects = self.context.plugin("objects")
        stones = objects.stones()
        last_placed_s = max(
            (self._since_s(s) for s in stones if s.state is StoneState.PLACED),
            default=float("-inf"),
        )
        left = [
            s
            for s in stones
            if s.state is StoneState.SET_ASIDE and self._since_s(s) < last_placed_s
        ]
        if not left:
            return failed("no stone was set aside for a reason that may be gone")
        for stone in left:
            objects.set_state(stone.id, StoneState.ON_GROUND, self.context.now_s())
        self.context.note("taken_up_again", stones=[stone.id for stone in left])
        return succeeded(f"stones {[stone.id for stone in left]} are tried again")

    def _since_s(self, stone: Stone) -> float:
        """Return since when a stone is in its state [s]."""
        history = self.context.plugin("objects").history(stone.id)
        before = [i for i, event in enumerate(history) if event.state is not stone.state]
        return float(history[before[-1] + 1 if before else 0].stamp_s)
