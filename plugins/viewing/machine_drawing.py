"""The machine in a recording: its solids once, its poses over time."""

import numpy as np
import rerun as rr
from executive_plugins.viewing.palette import MACHINE
from executive_plugins.viewing.solids import mesh

from executive.geometry.pose import inverse
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample

_ROOT = "world/machine"


class MachineDrawing:
    """Draws the links, and plots the joints relative to their limits."""

    def __init__(self, machine: Machine, recording: rr.RecordingStream) -> None:
        self._machine = machine
        self._recording = recording
        self._kinematics = Kinematics(machine)
        self._state: BaseState | None = None
        self._has_solids = False

    def set_state(self, state: BaseState) -> None:
        """Store the newest estimate; the machine is drawn with the next joint sample."""
        self._state = state if state.is_ready else None

    def draw(self, sample: JointSample) -> None:
        """Draw every link at its pose by joints and newest estimate, and plot the joints."""
        arm = np.array([sample.of(name)[0] for name in self._machine.arm_names])
        jaw_rad = sample.of(self._machine.jaw.name)[0]
        self._plot(sample, jaw_rad)
        if self._state is None:
            return
        self.draw_solids()
        frames = self._kinematics.frames(arm, jaw_rad)
        # The estimate is that of the cabin; the chassis follows from the turn joint of this sample.
        T_map_base = self._state.T_map_cabin @ inverse(frames[self._machine.cabin_link])
        if abs(sample.stamp_s - self._state.stamp_s) > 0.02:
            T_map_base = self._state.T_map_base
        for name in self._machine.links:
            T = T_map_base @ frames[name]
            self._recording.log(
                f"{_ROOT}/{name}", rr.Transform3D(translation=T[:3, 3], mat3x3=T[:3, :3])
            )

    def draw_solids(self) -> None:
        """Draw the solids once it is known where they are: else all would be at the origin."""
        if self._has_solids:
            return
        self._has_solids = True
        for number, (name, link) in enumerate(self._machine.links.items()):
            if link.shapes:
                shade = tuple(int(c * (1.0 if number % 2 else 0.8)) for c in MACHINE)
                solid = mesh([shape.vertices for shape in link.shapes], shade)
                self._recording.log(f"{_ROOT}/{name}", solid, static=True)

    def _plot(self, sample: JointSample, jaw_rad: float) -> None:
        self._recording.log(f"plots/jaw/{self._machine.jaw.name}", rr.Scalars(jaw_rad))
        for joint in self._machine.joints:
            self._recording.log(
                f"plots/effort/{joint.name}",
                rr.Scalars(sample.of(joint.name)[2] / joint.max_effort),
            )
