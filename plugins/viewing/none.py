"""The viewer that shows nothing."""

from executive.config import NoSettings
from executive.interfaces.viewing import Viewer


class NoViewer(Viewer):
    """Takes every value and forgets it."""

    def __init__(self, settings: NoSettings) -> None:
        """Keep nothing: there is nothing to set."""

    def open(self, path: str) -> None:
        """Write nothing."""

    def show(self, stamp_s: float, entity: str, value: object) -> None:
        """Show nothing."""
