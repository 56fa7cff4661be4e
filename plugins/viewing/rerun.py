"""Recording of a mission for the rerun viewer, in one file that can be scrubbed in time."""

from collections.abc import Mapping

import rerun as rr
from executive_plugins.viewing.layout import TIMELINE, layout
from executive_plugins.viewing.machine_drawing import MachineDrawing
from executive_plugins.viewing.message_drawing import draw, draw_tree
from pydantic import Field

from executive.config import Seconds, Settings
from executive.interfaces.viewing import Viewer
from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample


class RerunSettings(Settings):
    """Settings of the recording."""

    machine_period_s: Seconds = Field(
        0.1, gt=0, le=10, description="Time between two drawings of the machine [s]."
    )
    max_points: int = Field(
        120_000, ge=1000, description="Largest number of points drawn of one cloud."
    )


class RerunViewer(Viewer):
    """Writes a recording with its own layout; it opens no window, no port and no connection.

    Entities: `world/…` is in the map, `survey/…` are clouds in frames of their own, `tree` and
    `states/…` show the tree, `plots/…` scalars, `log/…` messages. The timeline is `mission`, in
    seconds.
    """

    Settings = RerunSettings

    def __init__(self, settings: RerunSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._recording: rr.RecordingStream | None = None
        self._drawn_s = -float("inf")
        self._states: dict[str, object] = {}

    def open(self, path: str) -> None:
        self._recording = rr.RecordingStream("executive", send_properties=False)
        self._recording.save(path, default_blueprint=layout())
        self._recording.set_log_time_enabled(False)
        self._recording.set_log_tick_enabled(False)
        self._recording.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self._drawing = MachineDrawing(self._machine, self._recording)

    def close(self) -> None:
        if self._recording is not None:
            self._recording.flush()
            self._recording.disconnect()
            self._recording = None

    def show(self, stamp_s: float, entity: str, value: object) -> None:
        if self._recording is None:
            return
        self._recording.set_time(TIMELINE, duration=stamp_s)
        if isinstance(value, BaseState):
            self._drawing.set_state(value)
        elif isinstance(value, JointSample):
            self._show_joints(stamp_s, value)
        elif isinstance(value, Mapping):
            self._show_tree(value)
        else:
            for path, components in draw(
                value, entity, self._machine.gripper, self._settings.max_points
            ):
                self._recording.log(path, components)

    def _show_joints(self, stamp_s: float, sample: JointSample) -> None:
        if stamp_s - self._drawn_s >= self._settings.machine_period_s - 1e-6:
            self._drawn_s = stamp_s
            self._drawing.draw(sample)

    def _show_tree(self, states: Mapping[str, object]) -> None:
        changed = {
            path: status for path, status in states.items() if self._states.get(path) != status
        }
        if changed and self._recording is not None:
            self._states.update(changed)
            for path, components in draw_tree(states, changed):
                self._recording.log(path, components)
