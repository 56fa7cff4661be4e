"""What happens on a worker of a cluster: it is admitted, receives inputs, and runs trials.

The functions are called by reference through `distributed`, so that a worker needs this package and
nothing else of the campaign. Each run happens in a process of its own, with the limits that hold on
one computer too.
"""

import asyncio
import errno
import os
import shutil
import socket
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

from distributed import Status as WorkerStatus
from distributed import Worker, get_worker

from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.fingerprint import local_fingerprint
from executive.campaign.execution.inputs import Chunk, InputCache
from executive.campaign.execution.isolation import Isolation
from executive.campaign.execution.parcel import pack
from executive.campaign.execution.pool import Lost
from executive.campaign.execution.processes.isolated_run import OUTPUT
from executive.campaign.execution.run_answer import NAME as ANSWER
from executive.campaign.trial import Outcome, Trial
from executive.clock import wall_s
from executive.errors import ConfigError

_POLL_EVERY_S = 0.1  # limits are held as often; the end of a run is told at once
CACHE = "executive-inputs"


@dataclass(frozen=True, slots=True)
class Order:
    """One run that a worker is asked for.

    Attributes:
        process: The process that was admitted; another one refuses the order.
        trial: What to run.
        inputs: Digest of each input by its name.
        keeps: Glob patterns of the files that are sent back.
        limit_bytes: Limit of their sizes together [byte].
    """

    process: str
    trial: Trial
    inputs: Mapping[str, str]
    keeps: tuple[str, ...]
    limit_bytes: int


@dataclass(frozen=True, slots=True)
class Delivery:
    """What a worker gives back: one of the first four, the files beside an outcome.

    Attributes:
        outcome: What came of the run, or that it was lost.
        missing: Digests of inputs that are not here (any more); nothing was begun.
        refusal: Why this worker cannot do the campaign's work at all.
        disk_full: Why no file could be written.
        files: The files of the run, packed.
    """

    outcome: Outcome | Lost | None = None
    missing: tuple[str, ...] = ()
    refusal: str = ""
    disk_full: str = ""
    files: bytes = b""


class WorkerSide:
    """What a worker's process keeps from run to run: a warm isolation and the cache of inputs."""

    def __init__(self, folder: Path) -> None:
        self.process = f"{socket.gethostname()}:{os.getpid()}:{wall_s():.6f}"
        self.lock = Lock()
        self.inputs = InputCache(folder)
        self.isolation = Isolation()


@cache
def _side(folder: Path) -> WorkerSide:
    return WorkerSide(folder)


def _side_of(worker: Worker) -> WorkerSide:
    return _side(_cache_folder(worker))


def _cache_folder(worker: Worker) -> Path:
    """Return the folder beside those of the worker processes, which are removed when they end."""
    return Path(worker.local_directory).resolve().parent / CACHE


async def introduce(dask_worker: Worker) -> dict[str, Any]:
    """Say who this worker is and what is installed there; `distributed` passes the worker.

    Returns:
        `process`: host and process, because another process at the same address is another worker;
        `cache`: host and folder of its inputs, which workers of one host can share;
        `fingerprint`: the fields of `Fingerprint`. No class is sent that a worker with another
        version of the package could have in another form.
    """
    side = _side_of(dask_worker)
    fingerprint = await asyncio.to_thread(local_fingerprint)
    cache_folder = f"{socket.gethostname()}:{_cache_folder(dask_worker)}"
    return {"process": side.process, "cache": cache_folder, "fingerprint": asdict(fingerprint)}


async def lacks(digest: str, dask_worker: Worker) -> bool:
    """Return whether an input is not in the cache."""
    return await asyncio.to_thread(_side_of(dask_worker).inputs.find, digest) is None


async def receive(digest: str, chunk: Chunk, dask_worker: Worker) -> None:
    """Write a part of an input that is arriving."""
    await asyncio.to_thread(_side_of(dask_worker).inputs.receive, digest, chunk)


async def complete(digest: str, dask_worker: Worker) -> None:
    """Verify an input that has arrived, and take it into the cache."""
    await asyncio.to_thread(_side_of(dask_worker).inputs.complete, digest)


def run_order(order: Order) -> Delivery:
    """Run a trial in a process of its own, and pack what is kept of it.

    A run whose future was cancelled, because the campaign has ended or counts this worker as lost,
    is killed.
    """
    worker = get_worker()
    side = _side_of(worker)
    lost = Lost(order.trial.number, f"worker {worker.address} was started again")
    if order.process != side.process:
        return Delivery(lost)
    folder = Path(worker.local_directory) / f"run-{order.trial.number}-{wall_s():.6f}"
    try:
        folder.mkdir()
        return _delivered(order, worker, side, folder)
    except ConfigError as error:
        return Delivery(refusal=str(error))
    except DiskFullError as error:
        return Delivery(disk_full=str(error))
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EDQUOT):
            raise
        return Delivery(disk_full=str(error))
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _delivered(order: Order, worker: Worker, side: WorkerSide, folder: Path) -> Delivery:
    with side.lock:
        places = {digest: side.inputs.find(digest) for digest in set(order.inputs.values())}
    missing = tuple(digest for digest, place in places.items() if place is None)
    if missing:
        return Delivery(missing=missing)
    inputs = {name: place for name, at in order.inputs.items() if (place := places[at])}
    outcome = _watched(worker, side.isolation, order.trial, folder, inputs)
    files = pack(folder, (*order.keeps, ANSWER, OUTPUT), order.limit_bytes)
    return Delivery(_named(outcome, worker), files=files)


def _watched(
    worker: Worker,
    isolation: Isolation,
    trial: Trial,
    folder: Path,
    inputs: Mapping[str, Path],
) -> Outcome | Lost:
    key = worker.get_current_task()
    running = isolation.begin(trial, folder, inputs)
    while (outcome := running.poll()) is None:
        if not _is_wanted(worker, key):
            running.kill()
        isolation.wait(_POLL_EVERY_S)
    return outcome


def _is_wanted(worker: Worker, key: object) -> bool:
    """Return whether somebody still waits for the result of a task."""
    task = worker.state.tasks.get(key)
    return (
        task is not None
        and task.state == "executing"
        and worker.status in (WorkerStatus.running, WorkerStatus.paused)
    )


def _named(outcome: Outcome | Lost, worker: Worker) -> Outcome | Lost:
    if isinstance(outcome, Lost):
        return replace(outcome, reason=f"{outcome.reason} on worker {worker.address}")
    return replace(outcome, worker=f"{outcome.worker} ({worker.address})")
