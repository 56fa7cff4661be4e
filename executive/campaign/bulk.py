"""Bulk work that is no campaign: one kind of work over many seeds, handed over as it comes.

It has what a campaign has (a process a run, limits, other machines), but no results of its own: the
caller takes what each run leaves, and knows itself what is missing when it is asked again.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.campaign.description.campaign import Campaign
from executive.campaign.engine import Plan, run_campaign
from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.execution.folder_lock import FolderLock
from executive.campaign.execution.pool import Pool
from executive.campaign.execution.progress import Progress
from executive.campaign.trial import Limits, Outcome, Trial

_LIMITS = Limits(time_s=3600.0, memory_bytes=4 << 30)


@dataclass(frozen=True, slots=True)
class Bulk:
    """What is asked for.

    Attributes:
        work: Installed name of the work.
        arguments: What it is given, as JSON holds it.
        seeds: A run each.
        limits: What a run may take.
    """

    work: str
    arguments: Mapping[str, Any]
    seeds: Sequence[int]
    limits: Limits = _LIMITS


@dataclass(frozen=True, slots=True)
class Result:
    """What came of one run.

    Attributes:
        seed: Its seed.
        outcome: How it ended.
        folder: What it left; removed when all are done.
    """

    seed: int
    outcome: Outcome
    folder: Path


def run_bulk(bulk: Bulk, scratch: Path, pool: Pool, take: Callable[[Result], None]) -> Progress:
    """Run all of it; the pool is closed and the scratch folder removed afterwards.

    Args:
        bulk: What is run.
        scratch: Folder for the time of the runs, on the disk that results are moved to; what an
            earlier process left there when it was killed is removed.
        pool: Where runs happen.
        take: Called with each run that has ended.

    Raises:
        ConfigError: If another process uses the folder, or the work refuses its arguments.
        DiskFullError: If no space is left. What was taken is kept.
    """
    _remove(scratch)
    folder = CampaignFolder(scratch)

    def hand_over(progress: Progress) -> None:
        for one in progress.ended:
            take(Result(bulk.seeds[one.number], one, folder.run(one.number, one.tries)))

    try:
        return run_campaign(_campaign(bulk), Plan(scratch), pool, hand_over)
    finally:
        _remove(scratch)


def _remove(scratch: Path) -> None:
    if scratch.exists():
        lock = FolderLock(CampaignFolder(scratch).lock)  # refused while another process uses it
        shutil.rmtree(scratch)
        lock.release()


def _campaign(bulk: Bulk) -> Campaign:
    trials = tuple(
        Trial(number, bulk.work, bulk.arguments, seed, {}, bulk.limits)
        for number, seed in enumerate(bulk.seeds)
    )
    return Campaign(
        name=bulk.work,
        description="",
        trials=trials,
        factors={},
        metrics=(),
        bounds=(),
        comparisons=(),
        digest=bulk.work,
        command="",
    )
