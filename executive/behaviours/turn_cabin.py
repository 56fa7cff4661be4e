"""Turn the cabin to a heading."""

from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.heading import HeadingSettings, facing
from executive.leaf.memory import OnResume
from executive.leaf.posture import POSTURE_NEEDS, move_to_posture
from executive.messages.hold import Hold


class TurnCabinSettings(HeadingSettings):
    """The heading."""


class TurnCabin(Action[TurnCabinSettings]):
    """Turn the cabin to a heading, by the shorter way that is free; the arm keeps its posture."""

    needs = POSTURE_NEEDS
    claims = (Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO

    def run(self, hold: Hold | None = None) -> Steps[None]:
        """Plan the turn and follow it.

        Args:
            hold: How a stone is held, if one is.
        """
        return (yield from move_to_posture(self.context, facing(self.context, self.settings), hold))
