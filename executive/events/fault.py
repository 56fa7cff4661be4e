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
    """

    number: int
    target: str
    how: str


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
