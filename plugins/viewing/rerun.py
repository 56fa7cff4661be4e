"""Recording of a mission for the rerun viewer, in a file that can be scrubbed in time, or live."""

from typing import TYPE_CHECKING

from executive_plugins.viewing.settings import RerunSettings

from executive.interfaces.viewing import Viewer
from executive.machine.machine import Machine

if TYPE_CHECKING:
    from executive_plugins.viewing.live_viewer import LiveViewer
    from executive_plugins.viewing.recording import Recording


class RerunViewer(Viewer):
    """Writes a recording with its own layout, shows it live, or both.

    Entities: `world/…` is in the map, `survey/…` are clouds in frames of their own, `tree` and
    `states/…` show the tree, `plots/…` scalars, `log/…` messages. The timeline is `mission`, in
    seconds. Only `show_live` opens a port, and that of this computer alone.
    """

    Settings = RerunSettings

    def __init__(self, settings: RerunSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._recordings: list[Recording] = []
        self._viewer: LiveViewer | None = None

    def open(self, path: str) -> None:
        # The library is an extra and takes a second to import: missions without a recording do
        # without it.
        import rerun as rr
        from executive_plugins.viewing.recording import Recording

        s = self._settings
        self._recordings.append(Recording(rr.FileSink(path), self._machine, s, s.batch_period_s))

    def show_live(self, port: int) -> str:
        import rerun as rr
        from executive_plugins.viewing.live_viewer import LiveViewer
        from executive_plugins.viewing.recording import Recording

        s = self._settings
        self._viewer = LiveViewer(port)
        self._recordings.append(
            Recording(rr.GrpcSink(self._viewer.url), self._machine, s, s.live_period_s)
        )
        return self._viewer.place

    def close(self) -> None:
        while self._recordings:
            self._recordings.pop().close()
        if self._viewer is not None:
            self._viewer.close()
            self._viewer = None

    def show(self, stamp_s: float, entity: str, value: object) -> None:
        for recording in self._recordings:
            recording.show(stamp_s, entity, value)
