"""Scan from a heading."""

from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.heading import HeadingSettings, facing
from executive.leaf.memory import OnResume
from executive.leaf.posture import POSTURE_NEEDS, move_to_posture
from executive.leaf.swing import SwingSettings, swing


class ScanFromSettings(SwingSettings, HeadingSettings):
    """The heading, and the sweep about it."""


class ScanFrom(Action[ScanFromSettings]):
    """Turn the cabin to a heading, and map the surroundings by swinging it about there.

    The jaws have to be empty.
    """

    needs = POSTURE_NEEDS
    claims = (Part.ARM, Part.CABIN, Part.LIDARS)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        goal = facing(self.context, self.settings)
        turned = yield from move_to_posture(self.context, goal, None)
        if not turned.success:
            return turned
        return (yield from swing(self.context, self.settings))
