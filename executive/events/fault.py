"""Events of faults on purpose, which `faults:` of a mission file describes."""

from dataclasses import dataclass

from executive.events.event import Event


@dataclass(frozen=True, slots=True, eq=False)
class FaultInjected(Event):
    """A fault that the mission file asks for has begun.

    Attributes:
        number: Its number in the file, from 1.
        target: The sensor, the actuator, or capability and verb of the plugin.
        how: What is wrong with it.
        is_hidden: It cannot be seen at once: `FaultShows` says from when.
    """

    number: int
    target: str
    how: str
    is_hidden: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class FaultShows(Event):
    """A fault of a drive keeps the arm farther from its path than a sound arm may be.

    Before that the arm is where the declared tracking error allows it to be, whatever its drives
    do.

    Attributes:
        number: Its number in the file, from 1.
        withheld: Commanded motion that the fault keeps from the worst joint [rad] or [m].
    """

    number: int
    withheld: float


@dataclass(frozen=True, slots=True, eq=False)
class FaultRemoved(Event):
    """A fault that the mission file asks for is over.

    Attributes:
        number: Its number in the file, from 1.
        target: The sensor, the actuator, or capability and verb of the plugin.
        how: What was wrong with it.
        acted: How many samples, commands or calls it has changed.
    """

    number: int
    target: str
    how: str
    acted: int
