"""Scan from a heading."""

from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.heading import HeadingSettings, facing
from executive.leaf.memory import OnResume
from executive.leaf.posture import POSTURE_NEEDS, move_to_posture
from executive.leaf.surroundings import held_kg, held_stone, held_surface
from executive.leaf.swing import SwingSettings, swing
from executive.messages.hold import Hold


class ScanFromSettings(SwingSettings, HeadingSettings):
    """The heading, and the sweep about it."""


class ScanFrom(Action[ScanFromSettings]):
    """Turn the cabin to a heading, and map the surroundings by swinging it about there.

    A stone in the jaws is swept along, and checked against the surroundings like the arm.
    """

    needs = POSTURE_NEEDS
    claims = (Part.ARM, Part.CABIN, Part.LIDARS)
    on_resume = OnResume.REDO

    def run(self, hold: Hold | None = None) -> Steps[None]:
        """Turn, then swing.

        Args:
            hold: How a stone is held, if one is.
        """
        goal = facing(self.context, self.settings)
        turned = yield from move_to_posture(self.context, goal, hold)
        if not turned.success:
            return turned
        if hold is None or held_stone(self.context) is None:
            return (yield from swing(self.context, self.settings))
        held = held_surface(self.context, hold)
        return (yield from swing(self.context, self.settings, held, held_kg(self.context)))
