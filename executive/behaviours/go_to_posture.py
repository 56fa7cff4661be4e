"""Go to a posture of the arm."""

from collections.abc import Mapping

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.config import Settings
from executive.errors import did_you_mean
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed
from executive.leaf.posture import POSTURE_NEEDS, move_to_posture
from executive.machine.machine import Machine
from executive.messages.hold import Hold


class GoToPostureSettings(Settings):
    posture: str | None = Field(
        None,
        min_length=1,
        examples=["carry"],
        description="Name of a posture in the machine's robot.yaml; `scan` and `carry` are always "
        "there.",
    )
    joints: Mapping[str, float] = Field(
        {}, description="Positions of joints by name [rad] or [m]; they go over the posture's."
    )
    keep_heading: bool = Field(
        True, description="Whether the cabin stays where it looks, unless `joints` turns it."
    )

    @model_validator(mode="after")
    def _names_something(self) -> "GoToPostureSettings":
        if self.posture is None and not self.joints:
            raise ValueError("give 'posture', 'joints' or both")
        return self


class GoToPosture(Action[GoToPostureSettings]):
    """Move the arm to a named posture or to joint positions; joints that are not named stay."""

    needs = POSTURE_NEEDS
    claims = (Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO

    def run(self, hold: Hold | None = None) -> Steps[None]:
        """Plan the motion and follow it.

        Args:
            hold: How a stone is held, if one is.
        """
        machine = self.context.machine()
        if refusal := _refusal(machine, self.settings):
            return failed(refusal, is_final=True)
        return (yield from move_to_posture(self.context, self._goal(machine), hold))

    def _goal(self, machine: Machine) -> Float:
        goal = self.context.arm()
        if self.settings.posture is not None:
            turn = machine.arm_names.index(machine.turn_joint)
            heading = goal[turn]
            goal = machine.posture(self.settings.posture)
            if self.settings.keep_heading:
                goal[turn] = heading
        for name, position in self.settings.joints.items():
            goal[machine.arm_names.index(name)] = position
        return goal


def _refusal(machine: Machine, settings: GoToPostureSettings) -> str:
    """Return what the machine lacks of what the settings name; empty if nothing."""
    posture = settings.posture
    if posture is not None and posture not in machine.postures:
        return f"{machine.name} has no posture '{posture}'{did_you_mean(posture, machine.postures)}"
    for name, position in settings.joints.items():
        if name not in machine.arm_names:
            return f"{machine.name} has no joint '{name}'{did_you_mean(name, machine.arm_names)}"
        joint = machine.joints[machine.arm_names.index(name)]
        if not (np.isfinite(position) and joint.lower <= position <= joint.upper):
            return f"{name} to {position:.3g}: its range is {joint.lower:.3g} to {joint.upper:.3g}"
    return ""
