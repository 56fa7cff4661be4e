"""Events of the mission as a whole: phases, its end, verdicts, errors of plugins."""

from dataclasses import dataclass

from executive.events.event import Event
from executive.messages.verdict import Trouble


@dataclass(frozen=True, slots=True, eq=False)
class PhaseChanged(Event):
    """The mission went from one phase to another."""

    before: str
    after: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class MissionEnded(Event):
    """The mission is over; the outcome is success, failure, stopped or fault."""

    outcome: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class StopFailed(Event):
    """The robot did not take the command to stop."""

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class VerdictGiven(Event):
    """A monitor recognised trouble with the held stone."""

    monitor: str
    trouble: Trouble
    detail: str


@dataclass(frozen=True, slots=True, eq=False)
class EstimatorStatusChanged(Event):
    """The status of the state estimate changed, at the stamp of a measurement [s]."""

    before: str
    after: str
    stamp_s: float
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Fault:
    """An error that escaped a plugin or a leaf, and where it was raised.

    Attributes:
        component: `capability plugin 'name'` or `behaviour 'Name'`.
        capability: Capability of the plugin; empty for a leaf.
        name: Name of the plugin or of the leaf.
        verb: Method that was called, such as `segment`.
        node: Path of the node that waited for it; empty outside of the tree.
        error: Class and message of the exception.
        place: `file:line` in the author's code where it was raised.
        traceback: Whole traceback as text.
    """

    component: str
    capability: str
    name: str
    verb: str
    node: str
    error: str
    place: str
    traceback: str

    @property
    def summary(self) -> str:
        """Return one line for a person: component, verb, error, place."""
        verb = f" in '{self.verb}'" if self.verb else ""
        place = f" ({self.place})" if self.place else ""
        return f"{self.component} failed{verb}: {self.error}{place}"


@dataclass(frozen=True, slots=True, eq=False)
class Faulted(Event):
    """An error escaped a plugin or a leaf; the mission ends in a safe stop."""

    fault: Fault


@dataclass(frozen=True, slots=True, eq=False)
class PluginFailed(Event):
    """A plugin whose selection says `on_error: fail` raised an error; the mission goes on."""

    fault: Fault


@dataclass(frozen=True, slots=True, eq=False)
class ObservationIgnored(Event):
    """The robot sends observations of a type that no selected plugin takes; told once a type."""

    type: str


@dataclass(frozen=True, slots=True, eq=False)
class WorkerReplaced(Event):
    """The worker process of a plugin was replaced.

    Attributes:
        capability: Capability of the plugin.
        name: Name of the plugin.
        verb: Verb that it computed then, which is tried again; empty if it computed none.
        reason: How the process ended.
    """

    capability: str
    name: str
    verb: str
    reason: str
