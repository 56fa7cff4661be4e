"""Two runs side by side: what differs in their settings, their course and their figures."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import zip_longest
from typing import Any

from executive.campaign.reporting.runs.read_run import ReadRun
from executive.journal import Entry

Two = tuple[Any, Any]


@dataclass(frozen=True, slots=True)
class FirstDifference:
    """The first entry of two journals that is not the same.

    Attributes:
        number: Its number in both, from 0.
        entries: The entries; None where a journal has ended before.
    """

    number: int
    entries: tuple[Entry | None, Entry | None]


@dataclass(frozen=True, slots=True)
class RunComparison:
    """What two runs have apart; each mapping holds the values of both by their name.

    Attributes:
        runs: The runs.
        settings: Settings and nodes of the mission that differ, by their path in the file.
        endings: Seed, outcome, reason, mission time and wall time.
        counts: The report's counts that differ.
        measurements: What each metric measured on both, None where it measured nothing.
        timings: Median wall time of each stage [ms].
        picks: Relocations in their order.
        first_difference: Where the journals part; None if they are the same.
    """

    runs: tuple[ReadRun, ReadRun]
    settings: Mapping[str, Two]
    endings: Mapping[str, Two]
    counts: Mapping[str, Two]
    measurements: Mapping[str, Two]
    timings: Mapping[str, Two]
    picks: Sequence[tuple[str, str]]
    first_difference: FirstDifference | None


def compare_runs(one: ReadRun, other: ReadRun) -> RunComparison:
    """Compare two runs."""
    medians = [
        {stage: of.median for stage, of in (run.whole.timings_ms if run.whole else {}).items()}
        for run in (one, other)
    ]
    return RunComparison(
        runs=(one, other),
        settings=_differing(dict(_flat(one.mission)), dict(_flat(other.mission))),
        endings=_both(_ending(one), _ending(other)),
        counts=_differing(_counts(one), _counts(other)),
        measurements=_both(one.measurements, other.measurements),
        timings=_both(*medians),
        picks=tuple(zip_longest(_picks(one), _picks(other), fillvalue="")),
        first_difference=_first_difference(one.entries, other.entries),
    )


def _both(one: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Two]:
    """Return the values of both by their name, in the order of the first."""
    return {name: (one.get(name), other.get(name)) for name in [*one, *(other.keys() - one.keys())]}


def _differing(one: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Two]:
    return {name: (a, b) for name, (a, b) in _both(one, other).items() if a != b}


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the scalars of a file with their paths, such as `plugins.robot.model`."""
    if isinstance(value, Mapping) and value:
        for key, inner in value.items():
            yield from _flat(inner, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and value:
        for number, inner in enumerate(value):
            yield from _flat(inner, f"{path}[{number}]")
    else:
        yield path, value


def _ending(run: ReadRun) -> dict[str, object]:
    """Return how a run ended, with None for what is not known."""
    report, whole = run.report, run.whole
    return {
        "mission": None if report is None else report.mission,
        "seed": None if whole is None else whole.seed,
        "outcome": None if report is None else report.outcome,
        "reason": None if report is None else report.reason,
        "ended_s": None if whole is None else whole.ended_s,
        "wall_s": None if whole is None else whole.wall_s,
    }


def _counts(run: ReadRun) -> dict[str, int]:
    return {} if run.whole is None else asdict(run.whole.counts)


def _picks(run: ReadRun) -> Iterator[str]:
    for pick in () if run.whole is None else run.whole.picks:
        attempts = ", ".join(attempt.outcome for attempt in pick.attempts)
        slot = f", slot {pick.slot}" if pick.placed else ""
        aside = f", set aside: {pick.set_aside}" if pick.set_aside else ""
        yield f"stone {pick.object}: {attempts}{slot}{aside}"


def _first_difference(one: Sequence[Entry], other: Sequence[Entry]) -> FirstDifference | None:
    for number, (a, b) in enumerate(zip_longest(one, other)):
        if a is None or b is None or _content(a) != _content(b):
            return FirstDifference(number, (a, b))
    return None


def _content(entry: Entry) -> tuple[object, ...]:
    return (entry.tick, entry.time_s, entry.kind, entry.node, repr(entry.event.payload()))
