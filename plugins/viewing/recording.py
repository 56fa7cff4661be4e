"""A recording for the rerun viewer: what is shown of a mission, written to one file."""

from collections.abc import Mapping

import rerun as rr
from executive_plugins.viewing.layout import TIMELINE, layout
from executive_plugins.viewing.machine_drawing import MachineDrawing
from executive_plugins.viewing.message_drawing import draw, draw_tree

from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample


class Recording:
    """A file that is being written; it ends with `close`."""

    def __init__(
        self, path: str, machine: Machine, machine_period_s: float, max_points: int
    ) -> None:
        """Begin a recording with its layout.

        Args:
            path: The file.
            machine: The machine that is drawn.
            machine_period_s: Time between two drawings of the machine [s].
            max_points: Largest number of points drawn of one cloud.
        """
        self._machine = machine
        self._machine_period_s = machine_period_s
        self._max_points = max_points
        self._drawn_s = -float("inf")
        self._states: dict[str, object] = {}
        self._stream = rr.RecordingStream("executive", send_properties=False)
        self._stream.save(path, default_blueprint=layout())
        self._stream.set_log_time_enabled(False)
        self._stream.set_log_tick_enabled(False)
        self._stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self._drawing = MachineDrawing(machine, self._stream)

    def close(self) -> None:
        """Write what is left and end the file."""
        self._stream.flush()
        self._stream.disconnect()

    def show(self, stamp_s: float, entity: str, value: object) -> None:
        """Write a message at a time [s]."""
        self._stream.set_time(TIMELINE, duration=stamp_s)
        if isinstance(value, BaseState):
            self._drawing.set_state(value)
        elif isinstance(value, JointSample):
            self._show_joints(stamp_s, value)
        elif isinstance(value, Mapping):
            self._show_tree(value)
        else:
            parts = draw(value, entity, self._machine.gripper, self._max_points)
            for path, components in parts:
                self._stream.log(path, components)

    def _show_joints(self, stamp_s: float, sample: JointSample) -> None:
        if stamp_s - self._drawn_s >= self._machine_period_s - 1e-6:
            self._drawn_s = stamp_s
            self._drawing.draw(sample)

    def _show_tree(self, states: Mapping[str, object]) -> None:
        changed = {
            path: status for path, status in states.items() if self._states.get(path) != status
        }
        if changed:
            self._states.update(changed)
            for path, components in draw_tree(states, changed):
                self._stream.log(path, components)
