"""Give a stone up."""

from pydantic import Field

from executive.config import Settings
from executive.events.stone import StoneSetAside
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, succeeded
from executive.messages.stone import StoneState


class SetAsideSettings(Settings):
    reason: str = Field(
        "every attempt failed",
        min_length=1,
        description="Text of the report, which adds the cause.",
    )


class SetAside(Condition[SetAsideSettings]):
    """Leave a stone where it is and report it: it is not attempted again.

    A stone that is lost stays lost, because nobody knows where it is.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self, stone: int) -> Outcome[None]:
        """Mark the stone, with the failure of the node before this one as the cause.

        Of several attempts, the cause of the first is named, too: those after it often fail for
        what it did.

        Args:
            stone: Id of the stone.
        """
        objects = self.context.use(ObjectDatabase)
        if objects.stone(stone).state is not StoneState.LOST:
            objects.set_state(stone, StoneState.SET_ASIDE, self.context.now_s())
        first, last = self.context.first_failure(), self.context.last_failure()
        causes = f"first, {first}; last, {last}" if first and first not in last else last
        reason = f"{self.settings.reason}: {causes}" if causes else self.settings.reason
        self.context.record(StoneSetAside(stone, reason))
        return succeeded(reason=f"stone {stone} is set aside")
