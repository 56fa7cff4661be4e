"""Where the runs of a command happen: processes of this computer, or workers of a cluster."""

import os
from typing import TYPE_CHECKING

from executive.errors import ConfigError
from executive.extras import require_extra

if TYPE_CHECKING:
    from executive.campaign.execution.pool import Pool


def pool_of(jobs: int | None, scheduler: str | None) -> "Pool":
    """Return the pool that `--jobs` and `--scheduler` ask for.

    Args:
        jobs: Runs side by side on this computer; the number of its cores if None.
        scheduler: Address of a dask scheduler, or None.

    Raises:
        ConfigError: If both are given, or no scheduler answers.
        MissingExtraError: If the packages for a cluster are not installed.
    """
    if scheduler is None:
        from executive.campaign.execution.local_pool import LocalPool

        return LocalPool(jobs or len(os.sched_getaffinity(0)))
    if jobs is not None:
        raise ConfigError("--jobs: the workers of the scheduler say how many runs they take")
    require_extra("--scheduler", "cluster")
    from executive.campaign.execution.cluster_pool import ClusterPool

    return ClusterPool(scheduler)
