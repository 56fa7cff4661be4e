"""Recording of a mission for the rerun viewer, in one file that can be scrubbed in time."""

from typing import TYPE_CHECKING

from executive_plugins.viewing.settings import RerunSettings

from executive.interfaces.viewing import Viewer
from executive.machine.machine import Machine

if TYPE_CHECKING:
    from executive_plugins.viewing.recording import Recording


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
        self._recording: Recording | None = None

    def open(self, path: str) -> None:
        # The library is an extra and takes a second to import: missions without a recording do
        # without it.
        from executive_plugins.viewing.recording import Recording

        s = self._settings
        self._recording = Recording(path, self._machine, s.machine_period_s, s.max_points)

    def close(self) -> None:
        if self._recording is not None:
            self._recording.close()
            self._recording = None

    def show(self, stamp_s: float, entity: str, value: object) -> None:
        if self._recording is not None:
            self._recording.show(stamp_s, entity, value)
