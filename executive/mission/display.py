"""The way to the viewer: a viewer that fails is let go, and the mission goes on."""

import logging

from executive.clock import Clock
from executive.interfaces.viewing import Viewer


class Display:
    """Shows values at the mission's time, if there is a viewer."""

    def __init__(self, viewer: Viewer | None, clock: Clock) -> None:
        self._viewer = viewer
        self._clock = clock

    @property
    def is_on(self) -> bool:
        """Whether anybody looks."""
        return self._viewer is not None

    def show(self, entity: str, value: object) -> None:
        """Hand one value on; the first error ends the showing and goes into the run's log."""
        if self._viewer is None:
            return
        try:
            self._viewer.show(self._clock.now_s(), entity, value)
        except Exception:  # whatever a viewer does, the machine is not stopped for it
            logging.getLogger(__name__).exception(
                "the viewer failed at '%s'; it is shown nothing more", entity
            )
            self._viewer = None
