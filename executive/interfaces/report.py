"""The report of a run: what its `report.json` holds, and what metrics read.

`docs/how-to/read_a_run.md` explains each field. `executive.interfaces.report_file` reads and writes
the file.
"""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Literal

from executive.arrays import Float
from executive.events.event import plain
from executive.events.finding import ListedStone, MapSaved
from executive.events.mission import Fault
from executive.events.site import BuildingEnded
from executive.events.stone import GraspRecord
from executive.interfaces.truth import Truth

MissionOutcome = Literal["success", "failure", "stopped", "fault"]


@dataclass(frozen=True, slots=True, eq=False)
class AttemptReport:
    """One attempt at a stone.

    Attributes:
        grasp: The grasp.
        outcome: How it ended: `placed`, `empty`, `not lifted`, `shifted`, `slip`, `drop`,
            `off` and so on.
        reason: Why, for a person.
        started_s: Mission time of its begin [s].
        ended_s: Mission time of its end [s].
        success: The chance of being placed that was expected of it, 0 to 1; None if none was.
    """

    grasp: GraspRecord
    outcome: str
    reason: str
    started_s: float
    ended_s: float
    success: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PickReport:
    """One relocation of a stone.

    Attributes:
        object: Number of the stone in the object database.
        attempts: The attempts in order of time.
        placed: The stone was released at a slot, and not seen off it afterwards.
        unverified: The mission ended between a release and the look that was to follow.
        slot: Number of the slot; None without a release.
        planned_pose: Planned T_map_object, shape (4, 4); None without a release.
        estimated_pose: T_map_object after the release or the re-alignment, shape (4, 4).
        set_aside: Why the stone was given up; None if it was not.
        seen: What a look after the release showed: `placed`, `off` or `unseen`; None without one.
        off_m: Horizontal distance from the plan by that look [m].
        tilt_rad: Tilt against the plan by that look [rad].
        turn_known: Whether it is known how the stone has turned over.
        mass_kg: What it weighed while it was carried [kg]; None if it was not weighed.
        mass_std_kg: Standard deviation of that [kg].
    """

    object: int
    attempts: tuple[AttemptReport, ...]
    placed: bool
    unverified: bool
    slot: int | None
    planned_pose: Float | None
    estimated_pose: Float | None
    set_aside: str | None
    seen: str | None
    off_m: float | None
    tilt_rad: float | None
    turn_known: bool | None
    mass_kg: float | None
    mass_std_kg: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Counts:
    """Sums over a run; docs/how-to/read_a_run.md tells what each counts."""

    picks: int
    placed: int
    attempts: int
    first_attempt: int
    slips: int
    drops: int
    empty: int
    set_aside: int
    known: int
    untouched: int
    off: int
    unverified: int
    turn_unknown: int
    unseen: int
    lost: int
    corrected: int
    registrations: int
    registrations_accepted: int
    scans: int
    not_retried: int
    plugin_failures: int


@dataclass(frozen=True, slots=True, eq=False)
class FigureReport:
    """A number that the mission reported, and its unit."""

    value: float
    unit: str


@dataclass(frozen=True, slots=True, eq=False)
class MarkReport:
    """A place that was marked at a mission time [s]; the other fields are those of `Marked`."""

    time_s: float
    text: str
    kind_of_place: Literal["point", "stone", "region"]
    position_map: Float
    stone: int | None
    region: str


@dataclass(frozen=True, slots=True, eq=False)
class SpanReport:
    """A time in which a fault on purpose was active [s]; without an end while it is."""

    from_s: float
    to_s: float | None


@dataclass(frozen=True, slots=True, eq=False)
class InjectedFault:
    """A fault on purpose.

    Attributes:
        number: Its number in the mission file, from 1.
        target: The sensor, the actuator, or capability and verb of the plugin.
        how: What was wrong with it.
        spans: When it was active.
        acted: How many samples, commands or calls it has changed.
    """

    number: int
    target: str
    how: str
    spans: tuple[SpanReport, ...]
    acted: int


@dataclass(frozen=True, slots=True, eq=False)
class PausesReport:
    """Number of pauses, and how long they took on the machine's clock and on the wall [s]."""

    count: int
    machine_s: float
    wall_s: float


@dataclass(frozen=True, slots=True, eq=False)
class LateTicksReport:
    """Late ticks.

    Attributes:
        count: Number of late ticks.
        worst_s: By how much the worst was late [s].
        limit: How many in a row end the mission.
        worst_cause: What took the most time in the worst: `mapping.add_scan_pair`, or
            `leaf in main/3:PlanPick`; empty if none was late.
        causes: Number of late ticks by what took the most time in them, the most frequent first.
    """

    count: int
    worst_s: float
    limit: int
    worst_cause: str = ""
    causes: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Resources:
    """What a run took from the computer.

    Attributes:
        cpu_s: Processor time [s].
        peak_memory_bytes: Largest resident memory [byte].
        compiling_s: Processor time of compiling numerical code, which is in `cpu_s` [s]; nearly 0
            in all but the first run on a computer. None in reports of versions that do not
            measure it.
    """

    cpu_s: float
    peak_memory_bytes: int
    compiling_s: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Timing:
    """Wall times of a stage: the median and the 95th percentile [ms], and their number."""

    median: float
    p95: float
    n: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MissionReport:
    """What a run reports; a field that has a default is left out of the file where it is empty.

    Attributes:
        mission: Name of the mission.
        seed: Its seed.
        outcome: How it ended.
        reason: Why, for a person.
        fault: What failed, if an error of a plugin or leaf ended the run.
        started_s: Mission time of the begin [s].
        ended_s: Mission time of the end [s].
        wall_s: Duration on the wall [s].
        real_time_factor: Mission time divided by the time on the wall outside of pauses.
        picks: The relocations, in the order in which they began.
        plugins: Names of the plugins by capability, or by `capability.name`.
        counts: Sums over the run.
        figures: The newest figure of each name.
        marks: Places that were marked.
        stones: The newest list of stones that the mission asked for.
        maps: Maps that were saved.
        structures: What was built.
        ignored_observations: Number of observations by type that no plugin takes.
        refused_observations: Number of observations by sensor and reason that cannot be true.
        missing_samples: Number of samples by sensor that did not come while they were due.
        scans_not_fused: Number of scans that the map did not take.
        stale_states: Number of states that were older than they may be when they were judged.
        faults: Faults on purpose.
        pauses: Pauses; None if the mission could not begin.
        late_ticks: Late ticks; None if the mission could not begin.
        resources: What the run took from the computer.
        timings_ms: Wall times of each stage.
        truth: What the simulator knows; None on a real machine.
    """

    mission: str
    seed: int
    outcome: MissionOutcome
    reason: str
    fault: Fault | None
    started_s: float
    ended_s: float
    wall_s: float
    real_time_factor: float
    picks: tuple[PickReport, ...]
    plugins: Mapping[str, tuple[str, ...]]
    counts: Counts
    figures: Mapping[str, FigureReport]
    marks: tuple[MarkReport, ...]
    stones: tuple[ListedStone, ...]
    maps: tuple[MapSaved, ...]
    structures: tuple[BuildingEnded, ...]
    ignored_observations: Mapping[str, int]
    refused_observations: Mapping[str, int] | None = None
    missing_samples: Mapping[str, int] | None = None
    scans_not_fused: int = 0
    stale_states: int = 0
    faults: tuple[InjectedFault, ...] = ()
    pauses: PausesReport | None = None
    late_ticks: LateTicksReport | None = None
    resources: Resources
    timings_ms: Mapping[str, Timing]
    truth: Truth | None = None

    def payload(self) -> dict[str, object]:
        """Return the fields as JSON holds them."""
        values = {one: getattr(self, one.name) for one in fields(self)}
        return {
            one.name: plain(value)
            for one, value in values.items()
            if value or one.default is MISSING
        }


@dataclass(frozen=True, slots=True, eq=False)
class CutOffReport:
    """All that is reported of a run whose process ended before it could report.

    The supervisor writes it (`executive.supervision.cut_off`).

    Attributes:
        mission: Name of the mission.
        outcome: A fault.
        reason: One line for a person.
        fault: What was computed when the process ended.
    """

    mission: str
    outcome: Literal["fault"]
    reason: str
    fault: Fault

    def payload(self) -> dict[str, object]:
        """Return the fields as JSON holds them."""
        return {one.name: plain(getattr(self, one.name)) for one in fields(self)}


@dataclass(frozen=True, slots=True, eq=False)
class MissionEnding:
    """How a run ended, which reports of all versions tell."""

    outcome: MissionOutcome
    reason: str | None = None
