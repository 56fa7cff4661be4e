"""A mission that listens for `executive ctl` while it runs."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from executive.control.server import ControlServer
from executive.mission.control.desk import Desk
from executive.mission.mission import Mission


@contextmanager
def controlled(mission: Mission, folder: Path) -> Iterator[None]:
    """Let people control a mission; where no socket can be made it runs all the same.

    Args:
        mission: The mission.
        folder: The run's folder, where the socket lies.
    """
    try:
        server = ControlServer(folder, mission.clock.wake)
    except OSError as error:
        told = "the mission takes no requests of `executive ctl`: no socket can be made in %s: %s"
        logging.getLogger(__name__).warning(told, folder, error)
        yield
        return
    desk = Desk(mission, server)
    mission.between.append(desk.serve)
    try:
        yield
    finally:
        desk.close()
        server.close()
