"""Campaigns of short runs: with kills at random, and what they add to the time of missions.

The work is that of the tests, tests/campaign/misbehaving.py, installed for the time of a trial.
"""

import os
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil

from executive.campaign.description.campaign import Campaign
from executive.campaign.description.mission_arguments import MissionArguments
from executive.campaign.engine import Plan, run_campaign
from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.execution.ledger import Ledger
from executive.campaign.execution.local_pool import LocalPool
from executive.campaign.execution.run_answer import NAME as ANSWER
from executive.campaign.execution.run_answer import read_answer
from executive.campaign.trial import Limits, Outcome, Status, Trial
from executive.tree.load import load_mission
from executive.tree.resolved import resolved_yaml

WORK = Path(__file__).parents[2] / "campaign" / "misbehaving.py"
MISSION = Path(__file__).with_name("short.yaml")
_LIMITS = Limits(time_s=60.0, memory_bytes=2 << 30)
_TARGETS = ("campaign", "server", "run")


def install(folder: Path) -> None:
    """Write the work and its entry point into a new folder, which then belongs on the path."""
    info = folder / "misbehaving.egg-info"
    info.mkdir(parents=True)
    (folder / "misbehaving.py").write_text(WORK.read_text())
    (info / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: misbehaving\nVersion: 0.1\n")
    points = "[executive.work.v1]\nmisbehaving = misbehaving:Misbehaving\n"
    (info / "entry_points.txt").write_text(points)


def campaign_of(work: str, arguments: dict[str, object], runs: int) -> Campaign:
    """Return a campaign of equal runs with the seeds from 1."""
    trials = tuple(
        Trial(number, work, arguments, number + 1, {}, _LIMITS) for number in range(runs)
    )
    digest = f"{work} {arguments} {runs}"
    return Campaign(work, "", trials, {}, (), (), (), digest, "a benchmark")


def outcomes_in(folder: Path) -> list[Outcome]:
    """Return the outcomes that a folder holds."""
    ledger = Ledger(CampaignFolder(folder).results)
    try:
        return list(ledger.outcomes())
    finally:
        ledger.close()


@dataclass(slots=True)
class Tally:
    """What came of a campaign that was killed again and again.

    Attributes:
        kills: Number of kills by target.
        runs: Number of trials.
        lost: Trials without an outcome, and outcomes that were on the disk and are not any more.
        doubled: Trials with more than one complete answer, or an outcome that changed.
        wrong: Outcomes that do not say what happened, such as `killed` of a run that nobody killed.
        statuses: Number of outcomes by status.
    """

    runs: int
    kills: Counter[str] = field(default_factory=Counter)
    lost: list[int] = field(default_factory=list)
    doubled: list[int] = field(default_factory=list)
    wrong: list[int] = field(default_factory=list)
    statuses: Counter[Status] = field(default_factory=Counter)


def killed_at_random(folder: Path, kills: int, rng: np.random.Generator, runs: int) -> Tally:
    """Run a campaign of short runs, kill its processes at random, and count what is not right.

    Args:
        folder: A new folder.
        kills: Number of kills by signal 9: in turn of the campaign, of the process that forks its
            runs, and of one of its runs.
        rng: Draws the moments, and which run is killed.
        runs: Number of runs; when they are finished, no more is killed.
    """
    tally, killed, seen = Tally(runs), set[str](), dict[int, Outcome]()
    out = folder / "out"
    install(folder / "installed")
    campaign = _begun(folder, runs)
    while tally.kills.total() < kills and campaign.poll() != 0:
        if campaign.poll() is not None:
            campaign = _begun(folder, runs)
        target = _TARGETS[tally.kills.total() % len(_TARGETS)]
        time.sleep(rng.uniform(0.0, 1.0))
        pid = None
        while pid is None and campaign.poll() is None:  # it takes a moment until it has runs
            pid = _pid_of(target, campaign.pid, rng)
        if pid is None or not _killed(pid):
            continue
        tally.kills[target] += 1
        killed.add(f"{pid}")
        if target == "campaign":
            campaign.wait()
            _compare(seen, _written(out), tally)
    while campaign.poll() != 0:
        if campaign.poll() is not None:
            campaign = _begun(folder, runs)
        campaign.wait()
    _judge(out, tally, seen, killed)
    return tally


def _begun(folder: Path, runs: int) -> subprocess.Popen[bytes]:
    path = f"{folder / 'installed'}:{os.environ.get('PYTHONPATH', '')}"
    return subprocess.Popen(
        [sys.executable, __file__, str(folder / "out"), str(runs)],
        env=os.environ | {"PYTHONPATH": path},
    )


def _killed(pid: int) -> bool:
    try:
        psutil.Process(pid).kill()
    except psutil.NoSuchProcess:
        return False
    return True


def _pid_of(target: str, campaign: int, rng: np.random.Generator) -> int | None:
    """Return a process of the campaign; None if there is none of the kind at the moment."""
    if target == "campaign":
        return campaign
    try:
        servers = psutil.Process(campaign).children()
        found = servers if target == "server" else [run for s in servers for run in s.children()]
        return int(rng.choice([one.pid for one in found])) if found else None
    except psutil.NoSuchProcess:
        return None


def _written(out: Path) -> dict[int, Outcome]:
    if not CampaignFolder(out).results.exists():
        return {}
    return {one.number: one for one in outcomes_in(out)}


def _compare(seen: dict[int, Outcome], found: dict[int, Outcome], tally: Tally) -> None:
    """Note what was on the disk before, and is not there any more or has changed."""
    tally.lost += [number for number in seen if number not in found]
    tally.doubled += [n for n, one in found.items() if n in seen and seen[n] != one]
    seen.update(found)


def _judge(out: Path, tally: Tally, seen: dict[int, Outcome], killed: set[str]) -> None:
    found = _written(out)
    _compare(seen, found, tally)
    tally.statuses = Counter(one.status for one in found.values())
    tally.lost += sorted(set(range(tally.runs)) - set(found))
    answers = Counter(int(path.parent.name.split("-")[0]) for path in _answers(out))
    tally.doubled += [number for number, count in answers.items() if count > 1]
    lost = _lost_tries(out)
    tally.wrong += [
        number
        for number, one in found.items()
        if not _is_right(one, answers[number], lost[number], killed)
    ]


def _is_right(one: Outcome, answers: int, lost: int, killed: set[str]) -> bool:
    if one.status is Status.DONE:
        return answers == 1 and one.answer["seed"] == one.number + 1
    if one.status is Status.KILLED:
        return answers == 0 and one.worker.rpartition(":")[2] in killed
    return answers == 0 and lost >= 2 and "lost 3 times" in one.reason


def _answers(out: Path) -> Iterator[Path]:
    return (out / "runs").glob(f"*/{ANSWER}")


def _lost_tries(out: Path) -> Counter[int]:
    database = sqlite3.connect(CampaignFolder(out).results)
    found = database.execute("SELECT number, count(*) FROM tries WHERE state='lost' GROUP BY 1")
    lost = Counter(dict(found.fetchall()))
    database.close()
    return lost


@dataclass(frozen=True, slots=True)
class Spread:
    """How a campaign of short missions used its slots.

    Attributes:
        in_use: Share of the time of all slots that runs spent on their own work, from the start of
            the campaign to its end.
        overhead_s: Median time that a run took beside its mission's own time [s]; the first of each
            slot is left out, because it waits for the imports.
        first_s: The same of the first run [s].
        done: Number of runs that have an answer.
    """

    in_use: float
    overhead_s: float
    first_s: float
    done: int


def spread_over(jobs: int, folder: Path, runs: int) -> Spread:
    """Run a short mission again and again, side by side.

    The mission's own time is that of its report, from the start of its plugins to its end; a run's
    own work is that with loading and metrics, as its process measured it. Both stretch as a whole
    where other programs take processor time.
    """
    text = resolved_yaml(load_mission(str(MISSION)))
    arguments = MissionArguments(mission=text).model_dump()
    campaign = campaign_of("mission", arguments, runs)
    started_s = time.monotonic()
    run_campaign(campaign, Plan(folder), LocalPool(jobs), lambda _: None)
    took_s = time.monotonic() - started_s
    done = [one for one in outcomes_in(folder) if one.status is Status.DONE]
    answers = [read_answer(folder / "runs" / f"{n}-1", campaign.trials[n]) for n in range(runs)]
    work_s = sum(answer.wall_s for answer in answers if answer is not None)
    beside_s = [one.wall_s - one.answer["report"]["wall_s"] for one in done]
    overhead_s = float(np.median(beside_s[jobs:] or [np.nan]))
    return Spread(work_s / (jobs * took_s), overhead_s, beside_s[0], len(done))


if __name__ == "__main__":
    run_campaign(
        campaign_of("misbehaving", {"behaviour": "answer", "for_s": 0.3}, int(sys.argv[2])),
        Plan(Path(sys.argv[1]), is_resumed=True),
        LocalPool(2),
        lambda _: None,
    )
