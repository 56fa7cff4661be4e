"""Runs on the workers of a cluster, behind a scheduler of dask.distributed.

The campaign, not the scheduler, chooses the worker of each run, and gives a worker no more runs
than it has threads. When a worker is lost, the scheduler may therefore not begin its run elsewhere
by itself: the pool reports the run as lost, and the campaign begins it again and counts that try.
With the scheduler's own repetitions (`retries`, `allowed-failures`) the number of tries would be
unknown, and a run whose worker is only cut off could be in progress twice.
"""

import asyncio
import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from queue import Empty, SimpleQueue

from distributed import Client, Future, Security
from distributed.comm import connect

from executive.campaign.execution.chosen_work import inputs_of, work_of
from executive.campaign.execution.cluster_workers import (
    AdmittedWorker,
    ClusterError,
    ClusterWorkers,
)
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.input_sender import InputSender
from executive.campaign.execution.parcel import unpack
from executive.campaign.execution.pool import Lost, Pool, RefusedError
from executive.campaign.execution.worker_run import Delivery, Order, run_order
from executive.campaign.trial import Outcome, Trial
from executive.clock import wall_s
from executive.errors import ConfigError, DataError, ExecutiveError

FILES_LIMIT_BYTES = 64 << 20  # of one run; they pass through the scheduler's memory
_CONNECT_S = 10.0
_LOOK_EVERY_S = 0.5  # at the workers: one message to the scheduler
_NEW_S = 0.1  # the same while workers introduce themselves
_SENDINGS = 3  # of an input that is not in a worker's cache though it was sent


@dataclass(slots=True)
class _Flight:
    """A run that a worker was asked for."""

    trial: Trial
    folder: Path
    tries: int
    worker: AdmittedWorker
    sendings: int = 0
    future: Future | None = None

    def cancel(self) -> None:
        """Let the worker end the run."""
        if self.future is not None:
            self.future.cancel()


class ClusterPool(Pool):
    """Runs trials on the workers of a cluster as they come and go."""

    def __init__(self, scheduler: str, files_limit_bytes: int = FILES_LIMIT_BYTES) -> None:
        """Connect with a scheduler.

        Args:
            scheduler: Its address, such as `tcp://10.0.0.1:8786`.
            files_limit_bytes: Limit of the files that are sent back of one run [byte].

        Raises:
            ClusterError: If no scheduler answers there, or a worker is refused.
        """
        self._limit_bytes = files_limit_bytes
        self._client = _connected(scheduler)
        self._workers = ClusterWorkers(self._client, scheduler)
        self._sender = InputSender(self._client)
        self._flights: dict[str, _Flight] = {}  # by the key of the future
        self._arrived: SimpleQueue[tuple[str, Delivery | BaseException]] = SimpleQueue()
        self._keys = count()
        self._looked_s = wall_s()
        try:
            self._workers.look()
        except ClusterError:
            self.close()
            raise

    @property
    def slots(self) -> int:
        return sum(worker.threads for worker in self._workers.admitted.values())

    def begin(self, trial: Trial, folder: Path, tries: int) -> None:
        folder.mkdir(parents=True)
        self._send(_Flight(trial, folder, tries, self._idle_worker()))

    def wait(self, timeout_s: float) -> Sequence[Outcome | Lost]:
        until_s = wall_s() + timeout_s
        ended: list[Outcome | Lost] = []
        try:
            while not ended and (now_s := wall_s()) < until_s:
                next_look_s = self._looked_s + (_NEW_S if self._workers.are_new else _LOOK_EVERY_S)
                if now_s >= next_look_s:
                    ended += self._look()
                self._receive(ended, 0.0 if ended else min(until_s, next_look_s) - now_s)
        except ExecutiveError as error:
            if not ended:
                raise
            self._arrived.put(("", error))  # after what has ended well, with the next call
        return ended

    def close(self) -> None:
        for flight in self._flights.values():
            flight.cancel()
        self._flights.clear()
        self._client.close(timeout=_CONNECT_S)

    def _idle_worker(self) -> AdmittedWorker:
        """Return the worker with the most free threads."""
        free = {one: worker.threads for one, worker in self._workers.admitted.items()}
        for flight in self._flights.values():
            if flight.worker.address in free:
                free[flight.worker.address] -= 1
        return self._workers.admitted[max(free, key=lambda one: free[one])]

    def _send(self, flight: _Flight) -> None:
        """Send what the worker lacks, then the order."""
        inputs = inputs_of(flight.trial)
        digests = self._sender.digests(inputs)
        caches = {one: worker.cache for one, worker in self._workers.admitted.items()}
        self._sender.send(inputs, digests, flight.worker.address, caches)
        work, _ = work_of(flight.trial)
        order = Order(
            flight.worker.process, flight.trial, digests, tuple(work.keeps), self._limit_bytes
        )
        key = f"executive-{self._client.id}-{flight.trial.number}-{next(self._keys)}"
        flight.future = self._client.submit(
            run_order, order, key=key, workers=[flight.worker.address], pure=False
        )
        self._flights[key] = flight
        flight.future.add_done_callback(self._fetch)

    def _fetch(self, future: Future) -> None:
        """Take the result of a future when it is there, in a thread of the client."""
        try:
            self._arrived.put((future.key, future.result()))
        except BaseException as error:  # cancelled, the worker is gone, or a fault of `run_order`
            self._arrived.put((future.key, error))

    def _look(self) -> list[Lost]:
        gone = self._workers.look()
        self._looked_s = wall_s()
        keys = [key for key, flight in self._flights.items() if flight.worker.address in gone]
        return [self._lost(key, "is gone") for key in keys]

    def _lost(self, key: str, what: str) -> Lost:
        flight = self._flights.pop(key)
        flight.cancel()
        return Lost(flight.trial.number, f"worker {flight.worker.address} {what}")

    def _receive(self, ended: list[Outcome | Lost], block_s: float) -> None:
        """Add what has arrived by now; wait for the first arrival for a time."""
        try:
            first = (
                self._arrived.get(timeout=block_s) if block_s > 0 else self._arrived.get_nowait()
            )
            self._add(ended, *first)
            while True:
                self._add(ended, *self._arrived.get_nowait())
        except Empty:
            return

    def _add(
        self, ended: list[Outcome | Lost], key: str, arrived: Delivery | BaseException
    ) -> None:
        if isinstance(arrived, ExecutiveError):
            raise arrived
        if key not in self._flights:  # reported as lost already
            return
        end = self._end_of(key, arrived)
        if end is not None:
            ended.append(end)

    def _end_of(self, key: str, arrived: Delivery | BaseException) -> Outcome | Lost | None:
        if not isinstance(arrived, Delivery):
            self._workers.look()  # the end of the scheduler is not the run's
            return self._lost(key, f"gave no result: {type(arrived).__name__}: {arrived}")
        flight = self._flights.pop(key)
        address = flight.worker.address
        if arrived.refusal:
            raise _refused(flight, arrived.refusal)
        if arrived.disk_full:
            raise DiskFullError(f"worker {address} has no space left: {arrived.disk_full}")
        if arrived.missing:
            return self._sent_again(flight, arrived.missing)
        if isinstance(arrived.outcome, Outcome):
            return self._delivered(flight, arrived.outcome, arrived.files)
        self._workers.dismiss(address)
        return arrived.outcome

    def _sent_again(self, flight: _Flight, missing: Sequence[str]) -> Lost | None:
        """Send inputs that a worker's cache does not hold any more; no run was begun."""
        flight.sendings += 1
        address = flight.worker.address
        if flight.sendings > _SENDINGS or address not in self._workers.admitted:
            return Lost(flight.trial.number, f"worker {address} does not keep its inputs")
        self._sender.forget(missing, flight.worker.cache)
        self._send(flight)
        return None

    def _delivered(self, flight: _Flight, outcome: Outcome, files: bytes) -> Outcome | Lost:
        try:
            unpack(files, flight.folder, self._limit_bytes)
        except DataError as error:
            return Lost(flight.trial.number, f"worker {flight.worker.address}: {error}")
        return replace(outcome, tries=flight.tries)


def _refused(flight: _Flight, reason: str) -> ConfigError:
    """Return the error for a refusal: the worker's, if it lacks what is installed here."""
    if not flight.worker.lacks:
        return RefusedError(flight.trial.number, reason)
    return ClusterError(
        f"worker {flight.worker.address} refuses trial {flight.trial.number}: {reason}. It lacks "
        f"what is installed here: {', '.join(flight.worker.lacks)}. Install it there too, start "
        "the worker again, and go on with --resume"
    )


def _connected(scheduler: str) -> Client:
    _silence()
    try:
        asyncio.run(_reach(scheduler))  # a client that cannot connect takes long to give up
        return Client(
            scheduler, timeout=_CONNECT_S, set_as_default=False, name="executive-campaign"
        )
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise ClusterError(
            f"no scheduler answers at {scheduler} ({error}). Start one with `dask scheduler`, and "
            "workers with `dask worker ADDRESS --nthreads 1`"
        ) from error


async def _reach(scheduler: str) -> None:
    """Connect once; the settings of `distributed` say with which certificates."""
    security = Security().get_connection_args("client")
    comm = await connect(scheduler, timeout=_CONNECT_S, **security)
    await comm.close()


def _silence() -> None:
    """Leave standard error to the campaign: what matters of a lost connection is an error of ours.

    `distributed` gives several of its loggers a level of their own.
    """
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)
