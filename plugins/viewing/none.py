"""The viewer that shows nothing."""

from executive.config import NoSettings
from executive.interfaces.viewing import Viewer


class NoViewer(Viewer):
    """Ignores every value."""

    def __init__(self, settings: NoSettings) -> None:
        """Do nothing: there are no settings."""

    def open(self, path: str) -> None:
        """Do nothing: no recording is written."""

    def show(self, stamp_s: float, entity: str, value: object) -> None:
        """Do nothing: nothing is shown."""
