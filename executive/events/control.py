"""Events of people who control a mission from another terminal."""

from dataclasses import dataclass

from executive.events.event import Event


@dataclass(frozen=True, slots=True, eq=False)
class ControlRequested(Event):
    """Somebody asked something of the mission by `executive ctl`; `status` is not kept.

    Attributes:
        verb: What was asked, such as `pause`.
        argument: Its argument; empty for none.
        target: Path of the node that was named; empty for none.
        user: Name of the user.
        uid: Number of the user.
        pid: Number of the process that asked.
        is_done: It was followed; else refused.
        reply: What was replied.
    """

    verb: str
    argument: str
    target: str
    user: str
    uid: int
    pid: int
    is_done: bool
    reply: str
