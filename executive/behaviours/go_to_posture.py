"""Go to a posture of the arm."""

from collections.abc import Iterator, Mapping

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.errors import did_you_mean
from executive.interfaces.declaration import MachineSettings, Refusal
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed
from executive.leaf.posture import POSTURE_NEEDS, move_to_posture
from executive.machine.machine import Machine
from executive.messages.hold import Hold


class GoToPostureSettings(MachineSettings):
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

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        posture = self.posture
        if posture is not None and posture not in machine.postures:
            near = did_you_mean(posture, machine.postures)
            yield Refusal(("posture",), f"{machine.name} has no posture '{posture}'{near}")
        for name, position in self.joints.items():
            if name not in machine.arm_names:
                near = did_you_mean(name, machine.arm_names)
                yield Refusal(("joints", name), f"{machine.name} has no joint '{name}'{near}")
                continue
            joint = machine.joints[machine.arm_names.index(name)]
            if not (np.isfinite(position) and joint.lower <= position <= joint.upper):
                bounds = f"{joint.lower:.3g} to {joint.upper:.3g}"
                told = f"{name} to {position:.3g}: its range is {bounds}"
                yield Refusal(("joints", name), told)


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
        if refusal := next(self.settings.refusals(machine), None):
            return failed(refusal.message, is_final=True)
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
