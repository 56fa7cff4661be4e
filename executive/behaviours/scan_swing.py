"""Swing the cabin with the lidars on."""

from typing import Any

from pydantic import Field

from executive.config import Radians, Seconds, Settings
from executive.leaf.action import Action, Steps
from executive.leaf.follow import follow
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.messages.command import SwitchLidars


class ScanSwingSettings(Settings):
    angle: Radians = Field(2.094, gt=0, le=6.3, description="Whole angle of the sweep [rad].")
    duration: Seconds = Field(20.0, gt=0, le=300, description="Least duration of the sweep [s].")


class ScanSwing(Action):
    """Map the surroundings by swinging the cabin about its present heading (Mascaro 2020, Sec.
    6.2).
    """

    Settings = ScanSwingSettings
    needs = ("robot", "mapping", "motion")

    def run(self, **inputs: Any) -> Steps:
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        plan = yield self.context.job(
            "motion", "swing", self.context.arm(), self.settings.angle, self.settings.duration
        )
        if plan.trajectory is None:
            return failed(f"no swing: {plan.reason}")
        robot = self.context.plugin("robot")
        robot.command(SwitchLidars(True))
        try:
            outcome = yield from follow(self.context, plan.trajectory)
        finally:
            robot.command(SwitchLidars(False))
        cloud = self.context.plugin("mapping").cloud()
        self.context.note("scanned", points=len(cloud))
        self.context.show("map", cloud)
        return outcome if not outcome.success else succeeded(f"{len(cloud)} points in the map")
