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
class PauseEnded(Event):
    """Mission time goes on after the operator paused the mission, or was asked.

    Attributes:
        machine_s: Machine time that passed in the pause [s].
    """

    machine_s: float


@dataclass(frozen=True, slots=True, eq=False)
class TickLate(Event):
    """A tick took longer than the period of the loop.

    Attributes:
        late_s: By how much [s].
        in_a_row: Number of late ticks in a row, this one included.
        step: What took the most time: `capability.verb`, `leaf` (a leaf's own code), a part of the
            loop (`robot.read`, `recorder`, `streams`, `watch`, `tree`, `journal`, `keeping`,
            `display`, `control`, `progress`, `loop`), or `wake`: before the tick, which began too
            late. Empty in a journal of an earlier version.
        in_node: Path of the node in which that was; empty outside of the tree.
        took_s: How long it took on the wall, without the steps within it [s].
        computed_s: Processor time of the loop in it [s]; where that is much less, the loop waited,
            for a disk or for a computer that was busy with something else.
    """

    late_s: float
    in_a_row: int
    step: str = ""
    in_node: str = ""
    took_s: float = 0.0
    computed_s: float = 0.0

    @property
    def cause(self) -> str:
        """Return what took the most time, for a person."""
        return f"{self.step} in {self.in_node}" if self.in_node else self.step


@dataclass(frozen=True, slots=True, eq=False)
class PartsReleased(Event):
    """The parts of the machine that a cancelled leaf drove have come to rest.

    Attributes:
        parts: Names of the parts.
        after_s: Machine time since the leaf was cancelled [s].
    """

    parts: tuple[str, ...]
    after_s: float


@dataclass(frozen=True, slots=True, eq=False)
class MissionEnded(Event):
    """The mission is over; the outcome is success, failure, stopped or fault."""

    outcome: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Resumed(Event):
    """The run goes on after it was cut off: killed, crashed, or without power.

    Attributes:
        lines: Number of lines of the journal before this one.
        cut_off_bytes: Length of a last line that was cut off and left out [byte].
        restored: Capabilities of the plugins whose state was kept and taken back.
        not_restored: Capabilities of those that keep nothing, or whose state was lost.
        under_way: Nodes of the leaves that were under way.
    """

    lines: int
    cut_off_bytes: int
    restored: tuple[str, ...]
    not_restored: tuple[str, ...]
    under_way: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class WorldObserved(Event):
    """The world was observed anew after a run was resumed, before anything moved.

    Attributes:
        status: Status of the state estimate.
        jaw_rad: Angle of the jaws [rad]; None if no joint sample came.
        held: Id of the stone that is held by the database; None for none.
        is_held: Whether the jaws hold something, by their angle and by the weight.
        payload_kg: Mass in the jaws [kg]; None if the machine does not measure it.
        seen: Ids of known stones that the scan shows where they were.
        unseen: Ids of known stones of which the scan shows nothing.
    """

    status: str
    jaw_rad: float | None
    held: int | None
    is_held: bool
    payload_kg: float | None
    seen: tuple[int, ...]
    unseen: tuple[int, ...]


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
