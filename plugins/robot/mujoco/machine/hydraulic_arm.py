"""The arm on cylinders: valves move oil, and the oil is a stiff spring between valve and joint."""

from collections.abc import Mapping
from typing import TypedDict, cast

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.machine.arm_servos import ArmServos
from executive_plugins.robot.mujoco.machine.valve_controller import (
    PERIOD_S,
    KeptController,
    ValveController,
)
from executive_plugins.robot.mujoco.machine.valves import KeptValves, Valves

from executive.arrays import Float
from executive.machine.hydraulics import Hydraulics
from executive.machine.machine import Machine


def add_friction(spec: mujoco.MjSpec, hydraulics: Hydraulics, machine: Machine) -> None:
    """Give the joints the dry friction of their cylinders.

    It acts between the oil and the joint, so that efforts from pressures contain it.
    """
    for joint in machine.joints:
        spec.joint(joint.name).frictionloss = hydraulics.friction * joint.max_effort


class _KeptOil(TypedDict):
    """What the next step depends on, besides the state of the simulation and of the servos."""

    oil: Float
    command: Float
    count: int
    valves: KeptValves
    controller: KeptController


class HydraulicArm(ArmServos):
    """Sends references through the controller and the valves to the oil of each cylinder.

    The actuators are those of the servos. Their reference is the position that a joint would have
    if its oil were rigid: closed valves hold the arm, and a load compresses the oil. It is at most
    as far from the joint as the largest effort compresses it, beyond which the relief valve opens.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        machine: Machine,
        hydraulics: Hydraulics,
        rng: np.random.Generator,
    ) -> None:
        super().__init__(model, data, machine)
        step_s = float(model.opt.timestep)
        self.controller = ValveController(hydraulics, machine, self.position())
        self._valves = Valves(hydraulics, machine, step_s, rng)
        self._every, self._count = round(PERIOD_S / step_s), 0
        self._command = np.zeros(len(machine.joints))
        self._oil = self.position()
        stiffness = model.actuator_gainprm[self._ids, 0]
        self._most = np.array([joint.max_effort for joint in machine.joints]) / stiffness

    def pace(self, velocity: Float) -> float:
        """Return the share of its speed at which a reference has enough flow, at most 1.

        Args:
            velocity: Velocity of the reference, shape (n,).
        """
        return self.controller.pace(velocity)

    def drive(self, position: Float, velocity: Float) -> None:
        """Advance controller, valves and oil by one step; references have shape (n,) each."""
        now = self.position()
        if self._count % self._every == 0:
            measured = self.controller.measured(now)
            self._command = self.controller.command(position, velocity, measured)
        self._count += 1
        self._valves.step(self._command)
        oil = self._oil + self._dt_s * self._valves.speed
        self._oil = np.clip(oil, now - self._most, now + self._most)
        self._data.ctrl[self._ids] = self._oil + self._lead_s * self._valves.speed

    def keep(self) -> Mapping[str, object]:
        return {
            **super().keep(),
            "oil": self._oil,
            "command": self._command,
            "count": self._count,
            "valves": self._valves.keep(),
            "controller": self.controller.keep(),
        }

    def restore(self, kept: Mapping[str, object]) -> None:
        super().restore(kept)
        own = cast(_KeptOil, kept)
        self._oil, self._command, self._count = own["oil"], own["command"], own["count"]
        self._valves.restore(own["valves"])
        self.controller.restore(own["controller"])
