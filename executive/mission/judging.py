"""A verdict from a process of its own, which is handed poses and nothing else."""

import multiprocessing
import traceback
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from executive import registry
from executive.errors import ExecutiveError
from executive.messages.building import AsBuilt


def verdict_of(built: AsBuilt, name: str) -> Mapping[str, Any]:
    """Return a judge's figures; the judge's process is started afresh.

    Raises:
        ExecutiveError: If the judge fails, or its process ends before it has answered.
    """
    afresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=afresh) as pool:
        try:
            found: Mapping[str, Any] | str = pool.submit(_judge, name, built).result()
        except BrokenProcessPool as error:
            raise ExecutiveError(f"the process of the judge '{name}' ended early") from error
    if isinstance(found, str):
        raise ExecutiveError(f"the judge '{name}' failed: {found}")
    return found


def _judge(name: str, built: AsBuilt) -> Mapping[str, Any] | str:
    """Return the figures, or how the judge failed, in words: not every error can be sent."""
    try:
        found: Mapping[str, Any] = registry.load(registry.JUDGES, name)().judge(built)
    except Exception:  # whatever escapes a judge, which anybody may bring
        return traceback.format_exc()
    return found
