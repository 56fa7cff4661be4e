"""Whole missions of the default kind, one a seed, and what their reports say."""

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bounds import Bound, Figure, held, judged

from executive.mission.run import Options, Run
from executive.tree.load import load_mission

NEAR_M = 0.30
HEADER = (
    "seed  outcome  near   median  worst  first attempts slips drops collisions   time_s  ratio"
)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one mission.

    Attributes:
        errors_m: Distances of the stones from the middle of their slots by the truth [m].
    """

    seed: int
    report: dict[str, Any]

    @property
    def errors_m(self) -> list[float]:
        found = [stone["slot_error_m"] for stone in self.report["truth"]["stones"]]
        return sorted(error for error in found if error is not None)

    @property
    def near(self) -> int:
        """Number of stones that stand near their slot."""
        return sum(error <= NEAR_M for error in self.errors_m)

    @property
    def stones(self) -> int:
        return len(self.report["truth"]["stones"])

    def line(self) -> str:
        report, counts, errors = self.report, self.report["counts"], self.errors_m
        middle = errors[len(errors) // 2] if errors else float("nan")
        worst = errors[-1] if errors else float("nan")
        return (
            f"{self.seed:4d}  {report['outcome']:8} {self.near:2d}/{self.stones:<2d} "
            f"{middle:6.2f} {worst:6.2f}"
            f" {counts['first_attempt']:6d} {counts['attempts']:8d} {counts['slips']:5d} "
            f"{counts['drops']:5d}"
            f" {len(report['truth']['collisions']):10d} {report['ended_s']:8.0f} "
            f"{report['real_time_factor']:6.1f}"
        )


def run(mission: str, seeds: Sequence[int], settings: Sequence[str]) -> Iterator[Outcome]:
    """Yield what came of each seed, up to one that a person stops."""
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            made = Run(
                load_mission(mission, list(settings)),
                Options(seed=seed, run_dir=Path(folder) / str(seed)),
            )
            report = made.execute(lambda mission: None).report
            yield Outcome(seed, report)
            if report["outcome"] == "stopped":  # by a person, who does not want the next one
                return


def figures(outcomes: Sequence[Outcome], are_scanned: bool) -> list[Figure]:
    """Hold missions against their bounds: 33 of 35 generated stones, 18 of 21 scans."""
    near, stones = (sum(getattr(one, name) for one in outcomes) for name in ("near", "stones"))
    good = sum(one.report["outcome"] == "success" for one in outcomes)
    collisions = sum(len(one.report["truth"]["collisions"]) for one in outcomes)
    slowest = min(one.report["real_time_factor"] for one in outcomes)
    share = Bound(18 / 21 if are_scanned else 33 / 35, is_least=True)
    return [
        judged("missions that succeed", f"{good} of {len(outcomes)}", "all", good == len(outcomes)),
        held(
            f"share of stones within {NEAR_M:.2f} m of their slot",
            near / stones if stones else float("nan"),
            share,
            f"{near} of {stones}",
        ),
        held("collisions", collisions, Bound(0)),
        held("slowest mission, times real time", slowest, Bound(2.0, is_least=True)),
    ]
