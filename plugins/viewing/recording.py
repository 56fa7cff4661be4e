"""A recording for the rerun viewer: what is shown of a mission, in a file or in a viewer."""

import logging
import threading
from collections.abc import Mapping
from datetime import timedelta

import rerun as rr
from executive_plugins.viewing.backlog import Backlog
from executive_plugins.viewing.layout import TIMELINE, layout
from executive_plugins.viewing.machine_drawing import MachineDrawing
from executive_plugins.viewing.message_drawing import draw, draw_tree
from executive_plugins.viewing.settings import RerunSettings

from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample

_CLOSING_S = 5.0  # for a viewer to take what is left; one that hangs never does


class Recording:
    """What is being recorded, to one file or viewer; it ends with `close`."""

    def __init__(
        self,
        sink: rr.FileSink | rr.GrpcSink,
        machine: Machine,
        settings: RerunSettings,
        batch_s: float,
    ) -> None:
        """Begin a recording with its layout.

        Args:
            sink: Where it goes.
            machine: The machine that is drawn.
            settings: How densely.
            batch_s: How long rows are gathered before they go there together, on the wall [s].
        """
        self._machine = machine
        self._machine_period_s = settings.machine_period_s
        self._max_points = settings.max_points
        self._drawn_s = -float("inf")
        self._states: dict[str, object] = {}
        batches = rr.ChunkBatcherConfig.DEFAULT()
        batches.flush_tick = timedelta(seconds=batch_s)
        self._stream = rr.RecordingStream(
            "executive", send_properties=False, batcher_config=batches
        )
        self._stream.set_sinks(sink, default_blueprint=layout())
        self._stream.set_log_time_enabled(False)
        self._stream.set_log_tick_enabled(False)
        self._stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self._drawing = MachineDrawing(machine, self._stream)
        self._backlog = Backlog(self._stream) if isinstance(sink, rr.GrpcSink) else None

    def close(self) -> None:
        """Hand over what is left, and end.

        A viewer that takes nothing any more is left alone: rerun would wait for it without end.
        """
        if self._backlog is None:
            self._stream.flush()
            self._stream.disconnect()
            return
        self._backlog.close()
        ending = threading.Thread(target=self._stream.disconnect, name="rerun", daemon=True)
        ending.start()
        ending.join(_CLOSING_S)
        if ending.is_alive():
            rr.unregister_shutdown()  # else this process would wait for the viewer at its end
            told = "the rerun viewer took nothing for %g s: it does not show the end of the mission"
            logging.getLogger(__name__).warning(told, _CLOSING_S)

    def show(self, stamp_s: float, entity: str, value: object) -> None:
        """Write a message at a time [s]; a viewer that hangs does not get it."""
        if self._backlog is not None and self._backlog.drops():
            return
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
