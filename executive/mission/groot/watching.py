"""A mission that Groot2 clients can watch, and hold at breakpoints, while it runs."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from executive.errors import ConfigError
from executive.events.control import ControlRequested
from executive.extras import require_extra
from executive.mission.groot.breakpoints import BY, Breakpoints
from executive.mission.groot.replies import Replies
from executive.mission.groot.shown_tree import ShownTree
from executive.mission.mission import Mission
from executive.tree.language import MissionFile

if TYPE_CHECKING:
    from executive.mission.groot.publisher import Publisher

_NOBODY = -1  # a client over TCP has no user and no process that could be known


def publisher_at(port: int | None) -> "Publisher | None":
    """Take a port of this computer, and the next one; None for not at all.

    Raises:
        ConfigError: If the extra `groot` is not installed, or a port is in use.
    """
    if port is None:
        return None
    require_extra("--groot", "groot")
    from executive.mission.groot.publisher import Publisher

    return Publisher(port)


@contextmanager
def shown_to_groot(
    description: MissionFile, mission: Mission, publisher: "Publisher | None"
) -> Iterator[None]:
    """Serve a mission's tree; one that is too large for the protocol runs without."""
    if publisher is None:
        yield
        return
    try:
        tree = ShownTree(description, mission)
        breakpoints = Breakpoints(tree.node, mission.wishes, publisher.publish)
        publisher.serve(Replies(tree, breakpoints).reply)
        mission.between.append(lambda: _keep(mission, breakpoints))
    except ConfigError as error:
        logging.getLogger(__name__).warning("%s", error)
    try:
        yield
    finally:
        publisher.close()


def _keep(mission: Mission, breakpoints: Breakpoints) -> None:
    """Put what a client has done to the breakpoints into the journal."""
    while breakpoints.told:
        verb, place = breakpoints.told.popleft()
        event = ControlRequested(
            verb=verb,
            argument=place,
            target="",
            user=BY,
            uid=_NOBODY,
            pid=_NOBODY,
            is_done=True,
            reply="",
        )
        mission.record("", event)
