"""What verbs with long bulk work share: where its runs happen, and what is said of failures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from executive.commands.campaigns.pool import pool_of
from executive.commands.console import say

if TYPE_CHECKING:
    from executive.campaign.bulk import Result


@dataclass(frozen=True, slots=True)
class Where:
    """Where runs happen.

    Attributes:
        scratch: Folder for the time of the runs, on the disk that results are moved to.
        jobs: Runs side by side on this computer.
        scheduler: Address of a dask scheduler, whose workers are taken instead; or None.
    """

    scratch: Path
    jobs: int = 1
    scheduler: str | None = None


def spread(
    work: str,
    arguments: Mapping[str, Any],
    seeds: Sequence[int],
    where: Where,
    take: Callable[[int, Path], None],
) -> int:
    """Run a work once for each seed, in processes of their own, and return the exit status.

    Args:
        work: Installed name of the work.
        arguments: What it is given, as JSON holds it.
        seeds: The seeds.
        where: Where runs happen.
        take: Called with seed and folder of each run that is done, before the folder is removed;
            what failed is said at the end.
    """
    from executive.campaign.bulk import Bulk, run_bulk
    from executive.campaign.trial import Status

    failures: list[Result] = []

    def take_or_note(result: "Result") -> None:
        if result.outcome.status is Status.DONE:
            take(result.seed, result.folder)
        else:
            failures.append(result)

    pool = pool_of(None if where.scheduler else where.jobs, where.scheduler)
    end = run_bulk(Bulk(work, arguments, seeds), where.scratch, pool, take_or_note)
    for one in failures:
        say(f"\n{work}, seed {one.seed}: {one.outcome.status.value}: {one.outcome.reason}", end="")
    if end.stopped_by:
        say(f"\nstopped by {end.stopped_by}; the same command goes on", end="")
    return int(bool(failures or end.stopped_by))
