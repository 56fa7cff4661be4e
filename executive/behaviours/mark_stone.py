"""Mark a stone with a text."""

from pydantic import Field

from executive.config import Settings
from executive.errors import DataError
from executive.events.finding import Marked
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.mark import Mark


class MarkStoneSettings(Settings):
    text: str = Field(min_length=1, examples=["cracked"], description="What is said about it.")


class MarkStone(Condition[MarkStoneSettings]):
    """Mark a known stone with a text: in the viewer, the journal and the report."""

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self, stone: int) -> Outcome[None]:
        """Record the mark and show it.

        Args:
            stone: Id of the stone.
        """
        try:
            known = self.context.use(ObjectDatabase).stone(stone)
        except DataError as error:
            return failed(str(error))
        text, position = self.settings.text, known.centroid_map
        self.context.record(Marked(text, "stone", position, stone=stone))
        self.context.show(f"marks/stone_{stone}", Mark(text, position))
        return succeeded(reason=f"stone {stone}: {text}")
