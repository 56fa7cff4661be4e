"""Values for the viewer; an error of the viewer ends the showing, and by default nothing else."""

from collections.abc import Callable
from typing import Any

from executive.clock import Clock
from executive.interfaces.viewing import Viewer
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample
from executive.tree.build import node_states


class Display:
    """Shows values at the mission's time, if there is a viewer."""

    def __init__(
        self, viewer: Viewer | None, clock: Clock, on_error: Callable[[Viewer, Exception], None]
    ) -> None:
        self._viewer = viewer
        self._clock = clock
        self._on_error = on_error

    @property
    def is_on(self) -> bool:
        """Whether there is a viewer."""
        return self._viewer is not None

    def show(self, entity: str, value: object) -> None:
        """Hand one value on; after an error of the viewer nothing more is handed on."""
        if self._viewer is None:
            return
        try:
            self._viewer.show(self._clock.now_s(), entity, value)
        except Exception as error:  # the mission decides what it means
            viewer, self._viewer = self._viewer, None
            self._on_error(viewer, error)

    def show_machine(self, root: Any, state: BaseState, joints: JointSample | None) -> None:
        """Hand on where the machine and its tree are."""
        self.show("tree", {node.path: node.status for node in node_states(root)})
        self.show("state", state)
        if joints is not None:
            self.show("joints", joints)
