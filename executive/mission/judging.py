"""A verdict from a process of its own, which is handed poses and nothing else."""

import multiprocessing
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from typing import Any

from executive import registry
from executive.messages.building import AsBuilt


def verdict_of(built: AsBuilt, name: str) -> Mapping[str, Any]:
    """Return a judge's figures; the judge's process is started afresh.

    Raises:
        BrokenProcessPool: If that process ends before it has answered.
        Exception: What the judge raises.
    """
    afresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=afresh) as pool:
        found: Mapping[str, Any] = pool.submit(_judge, name, built).result()
    return found


def _judge(name: str, built: AsBuilt) -> Mapping[str, Any]:
    found: Mapping[str, Any] = registry.load(registry.JUDGES, name)().judge(built)
    return found
