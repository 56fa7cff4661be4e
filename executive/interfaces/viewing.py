"""Viewing: show a mission over time."""

from abc import ABC, abstractmethod

from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin


class Viewer(Plugin, ABC):
    """Draw named values; it never answers back. A failing viewer never disturbs a mission."""

    capability = "viewing"

    @abstractmethod
    def open(self, path: str) -> None:
        """Record into a file. Called once, after `start`; only with `--record`."""

    def show_live(self, port: int) -> str:
        """Show the mission while it runs, in a viewer that listens at a port of this computer.

        One is started if none listens there; it must listen at 127.0.0.1 alone. Called once, after
        `start`; only with `--live`.

        Returns:
            Where the mission can be seen, for a person.

        Raises:
            ConfigError: If the plugin shows nothing live, or no viewer can be started.
        """
        raise ConfigError(
            f"the viewing plugin {type(self).__name__} shows nothing live; choose --set "
            "viewing.plugin=rerun, or leave out --live"
        )

    @abstractmethod
    def show(self, stamp_s: float, entity: str, value: object) -> None:
        """Show a message under a name, such as (`map`, Cloud) or (`grasp`, Grasp), at a mission
        time [s].

        Kinds: Cloud, Segmentation, Stone, Grasp, MotionPlan, BaseState, JointSample, Alignment,
        Slot, Mark, Region, and for the tree a mapping of node path to status. Other kinds are
        ignored.
        """
