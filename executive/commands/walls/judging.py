"""A verdict from a process of its own, which is handed poses and nothing else."""

import multiprocessing
from collections.abc import Mapping
from typing import Any

from executive import registry
from executive.messages.building import AsBuilt

JUDGES = "judge"


def judges() -> tuple[str, ...]:
    """Return the names of the judges that are installed."""
    return registry.names(JUDGES)


def verdict_of(built: AsBuilt, name: str) -> Mapping[str, Any]:
    """Return a judge's figures; the judge's process is started afresh."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found: Mapping[str, Any] = pool.apply(_judge, (name, built))
    return found


def _judge(name: str, built: AsBuilt) -> Mapping[str, Any]:
    found: Mapping[str, Any] = registry.load(JUDGES, name)().judge(built)
    return found
