"""Swing the cabin with the lidars on."""

from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.memory import OnResume
from executive.leaf.swing import SwingSettings, swing


class ScanSwingSettings(SwingSettings):
    """Angle and duration of the sweep."""


class ScanSwing(Action[ScanSwingSettings]):
    """Map the surroundings by swinging the cabin about its present heading.

    Source: Mascaro et al. 2020, Sec. 6.2.
    """

    needs = (Robot, Mapper, MotionPlanner)
    claims = (Part.ARM, Part.CABIN, Part.LIDARS)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        return (yield from swing(self.context, self.settings))
