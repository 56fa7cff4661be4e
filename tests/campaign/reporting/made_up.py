"""Made-up campaigns: results drawn from stated distributions, in a ledger."""

import sqlite3
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from itertools import product
from pathlib import Path

import numpy as np

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.load import load_campaign
from executive.campaign.description.options import CampaignOptions
from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.execution.ledger import Ledger, Session
from executive.campaign.execution.ledger_rows import outcome_row
from executive.campaign.figures.bound import Bound
from executive.campaign.figures.comparison import Comparison
from executive.campaign.trial import Limits, Outcome, Status, Trial

WAITS = """\
api: 1
mission: waits
plugins:
  robot: {plugin: kinematic}
  estimation: gnss_imu_filter
trees:
  main: {wait: 0.2 s}
"""
MISSION = "api: 1\nmission: made_up\ntrees:\n  main:\n    wait: 1 s\n"


def campaign(
    seeds: Sequence[int] = range(1, 21), factors: Mapping[str, tuple[str, ...]] | None = None
) -> Campaign:
    """Return a campaign over all combinations of the factors' levels."""
    factors = {"estimation": ("dual_graph", "error_state_ekf")} if factors is None else factors
    cells = [dict(zip(factors, levels, strict=True)) for levels in product(*factors.values())]
    limits = Limits(60.0, 2**30)
    trials = tuple(
        Trial(number, "mission", {"mission": MISSION}, seed, cell, limits)
        for number, (seed, cell) in enumerate(product(seeds, cells))
    )
    first = next(iter(factors), "")
    comparisons = (Comparison(first, factors[first][0], ("success",)),) if first else ()
    return Campaign(
        name="two_estimators",
        description="Whether the dual graph places stones more surely than the filter.",
        trials=trials,
        factors=factors,
        metrics=("success", "placement_error"),
        bounds=(
            Bound("success", "share", 0.9, is_least=True),
            Bound("placement_error", "p95", 0.3, is_least=False),
        ),
        comparisons=comparisons,
        digest="0123456789abcdef",
        command="executive campaign two_estimators.yaml --seeds 1:20",
    )


def outcomes(of: Campaign, share: float = 0.85, seed: int = 0) -> Iterator[Outcome]:
    """Yield outcomes: some missions fail, a few runs have no answer."""
    chance = np.random.default_rng(seed)
    levels = {tuple(trial.levels.values()): None for trial in of.trials}
    rank = {cell: number for number, cell in enumerate(levels)}
    for trial in of.trials:
        worse = 0.4 * rank[tuple(trial.levels.values())] / max(1, len(rank) - 1)
        draw = chance.random()
        kind = {0: Status.CRASHED, 1: Status.TIMED_OUT, 2: Status.KILLED}.get(int(draw * 100))
        if kind:
            reason = {
                Status.CRASHED: "signal 11 (segmentation fault)",
                Status.TIMED_OUT: "longer than 60 s",
                Status.KILLED: "signal 9, from outside of the campaign",
            }[kind]
            yield Outcome(trial.number, kind, reason, {}, 60.0, 30.0, 2**29, 1, "here:1")
            continue
        good = bool(chance.random() < share - worse)
        errors = chance.gamma(2.0, 0.04 + 0.1 * worse, size=int(chance.integers(3, 8)))
        report = {
            "outcome": "success" if good else "failure",
            "reason": "" if good else f"only {int(chance.integers(1, 5))} of 7 stones placed",
        }
        measurements = {
            "success": {"hits": int(good), "of": 1},
            "placement_error": {"values": errors.tolist()},
        }
        answer = {"report": report, "measurements": measurements}
        wall_s = float(chance.gamma(8.0, 4.0))
        peak = int(4e8 + 1e8 * chance.random())
        yield Outcome(trial.number, Status.DONE, "", answer, wall_s, wall_s, peak, 1, "here:2")


def write_ledger(
    folder: Path, of: Campaign, found: Iterable[Outcome], is_durable: bool = True
) -> None:
    """Write the results of a campaign as the engine does.

    Args:
        folder: The campaign's folder.
        of: The campaign.
        found: What came of its trials.
        is_durable: Whether each result is on the disk before the next; thousands take minutes so.
    """
    path = CampaignFolder(folder).results
    with closing(Ledger(path)) as ledger:
        ledger.begin(of.trials, of.digest)
        ledger.add_session(Session("2026-01-02T03:04:05+00:00", "here:1", of.command, "0.2", "f00"))
        if is_durable:
            for outcome in found:
                ledger.claim(outcome.number)
                ledger.finish(outcome)
    if not is_durable:
        with closing(sqlite3.connect(path)) as database, database:
            marks = ", ".join("?" * 9)
            rows = map(outcome_row, found)
            database.executemany(f"INSERT INTO outcomes VALUES ({marks})", rows)


def waiting(folder: Path, seeds: str) -> Campaign:
    """Write a campaign of a short mission into its folder, as the engine does, and return it."""
    folder.mkdir()
    mission = folder / "waits.yaml"
    mission.write_text(WAITS, encoding="utf-8")
    found = load_campaign(str(mission), CampaignOptions(seeds=seeds))
    (folder / "campaign.yaml").write_text(found.text, encoding="utf-8")
    return found
