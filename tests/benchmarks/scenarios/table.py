"""The table of the estimators: a row for each figure, a column for each estimator, and the
bounds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from bounds import Bound, Figure, held

Values = Mapping[str, Mapping[str, Sequence[float]]]  # estimator → figure → one value a trial


@dataclass(frozen=True, slots=True)
class Row:
    """One figure.

    Attributes:
        label: What is measured, with its unit.
        figure: Its name in a trial's figures; several are pooled.
        must, stretch: Bounds on it; None where there is none.
        is_mean: Whether the mean over trials is held against the bounds; else the worst.
        is_least: Whether the bounds are lower ones.
        is_best: Whether the best is held against the bounds, for what else runs on the computer
            only makes it worse.
        digits: Decimals.
    """

    label: str
    figure: str | tuple[str, ...]
    must: float | None = None
    stretch: float | None = None
    is_mean: bool = False
    is_least: bool = False
    is_best: bool = False
    digits: int = 1

    def of(self, values: Mapping[str, Sequence[float]]) -> Sequence[float]:
        """Return this figure's values of all trials."""
        names = (self.figure,) if isinstance(self.figure, str) else self.figure
        return [value for name in names for value in values.get(name, ())]

    def held(self, values: Sequence[float]) -> float:
        """Return the number that is held against the bounds."""
        if self.is_mean:
            return float(np.mean(values))
        return float(min(values) if self.is_least or self.is_best else max(values))

    @property
    def bound(self) -> Bound | None:
        """The bound, where there is a must."""
        if self.must is None:
            return None
        return Bound(self.must, self.stretch, self.is_least)

    def is_missed(self, values: Sequence[float]) -> bool:
        """Return whether the figure misses a must."""
        return self.bound is not None and not self.bound.holds(self.held(values))

    def is_stretched(self, values: Sequence[float]) -> bool:
        """Return whether the figure reaches the stretch, where there is one."""
        if self.stretch is None:
            return False
        return Bound(self.stretch, is_least=self.is_least).holds(self.held(values))


_OUTAGES = ("outage 45 s", "outage 160 s")

ROWS = (
    Row(
        "antenna's position error, bias [cm]", "position: bias", 0.18, 0.15, is_mean=True, digits=2
    ),
    Row("antenna's position error, std [cm]", "position: std", 1.28, 0.6, is_mean=True, digits=2),
    Row("cabin's position error, distance [cm]", "position: distance", is_mean=True, digits=2),
    Row("consistency, mean [cm]", "consistency: mean", 0.58, 0.3, is_mean=True, digits=2),
    Row("consistency, std [cm]", "consistency: std", 3.16, 0.5, is_mean=True, digits=2),
    Row(
        "error squared over covariance, inside the 99 % bound [%]",
        "nees: inside",
        90,
        is_least=True,
        is_mean=True,
    ),
    Row("the same, mean (6 if honest)", "nees: mean", is_mean=True, digits=2),
    Row("clean data: fixes rejected [%]", "clean: rejected", 0.5, 0.0, digits=2),
    Row("clean data: time not GLOBAL [%]", "clean: not global", digits=2),
    Row(
        "the same without lidar: fixes rejected [%]",
        "no lidar, clean: rejected",
        0.5,
        0.0,
        digits=2,
    ),
    Row(
        "the same without lidar: antenna's position error, std [cm]",
        "no lidar, position: std",
        is_mean=True,
        digits=2,
    ),
    Row("fixes that wander by 1 cm: rejected [%]", "wander, clean: rejected", 0.5, 0.0, digits=2),
    Row("fixes that wander by 1 cm: time not GLOBAL [%]", "wander, clean: not global", digits=2),
    Row("spikes of 3 to 4 m: error [cm]", "spikes: error", 8, 4),
    Row("plateau of 1 m for 5 s: error [cm]", "plateau: error", 15, 8),
    Row("ramp of 0.1 m/s to 2 m: flagged after [s]", "ramp: flagged", 20),
    Row("ramp of 0.1 m/s to 2 m: error [cm]", "ramp: error", 30, 15),
    Row("datum moved by 5 m: anchored anew after [s]", "datum: anchored", 15),
    Row("datum moved by 5 m: flagged", "datum: flagged", 1, is_least=True, digits=0),
    *(Row(f"{o}: error [% of way]", f"{o}: share", 0.7, digits=2) for o in _OUTAGES),
    *(
        Row(f"{o}: beyond odometry's own [% of way]", f"{o}: beyond", None, 0.2, digits=2)
        for o in _OUTAGES
    ),
    Row(
        "odometry frame: step beyond v·dt [mm]",
        ("plateau: step", *(f"{o}: step" for o in _OUTAGES)),
        10,
        2,
        digits=2,
    ),
    Row(
        "back in GLOBAL after good fixes [s]",
        ("plateau: back", *(f"{o}: back" for o in _OUTAGES)),
        1.5,
        1.0,
        digits=2,
    ),
)

_HOW = (
    ("thread", "awake", "thread time, waiting awake"),
    ("wall", "awake", "wall, waiting awake"),
    ("thread", "asleep", "thread time, sleeping between"),
)

TIMING_ROWS = (
    *(
        Row(
            f"one inertial sample, {what}, {how} [µs]",
            f"service: {what}, {clock}, {state}",
            *bounds,
            is_best=True,
            digits=0,
        )
        for what, bounds in (("mean", (41, 15)), ("p99", (150, 60)))
        for clock, state, how in _HOW
    ),
    Row(
        "extra stall beside the smoother's process, thread time [ms]",
        "stall: thread",
        5,
        2,
        is_best=True,
        digits=2,
    ),
    Row(
        "extra stall beside the smoother's process, wall [ms]",
        "stall: wall",
        5,
        2,
        is_best=True,
        digits=2,
    ),
    Row(
        "extra stall with the smoother in line, thread time [ms]",
        "stall in line: thread",
        is_best=True,
        digits=2,
    ),
    Row(
        "one update of the smoother, p99, thread time [ms]",
        "update: p99, thread",
        15,
        6,
        is_best=True,
    ),
    Row("one update of the smoother, p99, wall [ms]", "update: p99, wall", 15, 6, is_best=True),
    Row("one update of the smoother, mean, thread time [ms]", "update: mean, thread", is_best=True),
    Row("updates a second of measurements", "update: rate", is_mean=True),
)


def table(rows: Sequence[Row], values: Values) -> str:
    """Return the rows as Markdown: each estimator beside the bounds."""
    names = tuple(values)
    lines = ["| what | must | stretch | n | " + " | ".join(f"`{name}`" for name in names) + " |"]
    lines.append("|---" * (4 + len(names)) + "|")
    for row in rows:
        per_name = [row.of(values[name]) for name in names]
        if not any(per_name):
            continue
        counts = [str(len(v)) for v in per_name if v]
        n = counts[0] if len(set(counts)) == 1 else " / ".join(counts)
        cells = [_cell(row, v) for v in per_name]
        bounds = f"{_bound(row.must, row)} | {_bound(row.stretch, row)}"
        lines.append(f"| {row.label} | {bounds} | {n} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def figures(rows: Sequence[Row], values: Values, name: str) -> list[Figure]:
    """Return the figures of one estimator that have a bound."""
    found = []
    for row in rows:
        trials = row.of(values.get(name, {}))
        if trials and row.bound is not None:
            words = f"{row.held(trials):.{row.digits}f}"
            found.append(held(f"{name}: {row.label}", row.held(trials), row.bound, words))
    return found


def _bound(limit: float | None, row: Row) -> str:
    return "" if limit is None else str(Bound(limit, is_least=row.is_least))


def _cell(row: Row, values: Sequence[float]) -> str:
    """Median and worst, or mean and spread; bold where the must is missed, a star where the stretch
    is reached.
    """
    if not values:
        return ""
    first, second = (
        (np.mean(values), np.std(values)) if row.is_mean else (np.median(values), row.held(values))
    )
    joined = f"{first:.{row.digits}f} {'±' if row.is_mean else '…'} {second:.{row.digits}f}"
    if row.is_missed(values):
        return f"**{joined}**"
    return f"{joined} *" if row.is_stretched(values) else joined
