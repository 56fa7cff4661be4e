"""Viewing: show a mission over time."""

from abc import ABC, abstractmethod

from executive.interfaces.plugin import Plugin


class Viewer(Plugin, ABC):
    """Draw named values; it never answers back. A failing viewer never disturbs a mission."""

    capability = "viewing"

    @abstractmethod
    def open(self, path: str) -> None:
        """Record into a file. Called once, after `start`; only with `--record`."""

    @abstractmethod
    def show(self, stamp_s: float, entity: str, value: object) -> None:
        """Show a message under a name, such as (`map`, Cloud) or (`grasp`, Grasp), at a mission
        time [s].

        Kinds: Cloud, Segmentation, Stone, Grasp, MotionPlan, BaseState, JointSample, Alignment,
        Slot, Mark, Region, and for the tree a mapping of node path to status. Other kinds are
        ignored.
        """
