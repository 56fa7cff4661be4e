"""Values for the viewer; an error of the viewer ends the showing, and by default nothing else."""

from collections.abc import Callable

from executive.clock import Clock
from executive.interfaces.viewing import Viewer


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
