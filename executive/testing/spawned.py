"""The same exercise in a spawned process, as a worker of a mission would compute it."""

import multiprocessing as mp
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import lru_cache

from executive.testing.digest import digest
from executive.testing.exercise import exercise_of
from executive.testing.subject import Subject


def spawned_digest(subject: Subject, timeout_s: float) -> str:
    """Return the digest of the answer that a plugin gives in another process.

    Raises:
        TimeoutError: If it takes longer than the timeout, the process's start included.
    """
    return _pool(tuple(sys.path)).submit(_digest, subject).result(timeout_s)


@lru_cache(maxsize=1)
def _pool(path: tuple[str, ...]) -> ProcessPoolExecutor:
    """Return one process for all plugins on a path: its start, with the imports, costs seconds."""
    return ProcessPoolExecutor(1, mp_context=mp.get_context("spawn"))


def _digest(subject: Subject) -> str:
    exercise = exercise_of(subject.capability)
    if exercise is None:
        raise LookupError(f"no exercise for {subject.capability}")
    with subject.started() as plugin:
        return digest(exercise.run(plugin, exercise.inputs(subject.machine)))
