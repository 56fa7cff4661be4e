"""The workers of a cluster as a campaign sees them: who came, who is gone, who is refused."""

from collections.abc import Mapping
from dataclasses import dataclass
from queue import SimpleQueue
from threading import Thread
from typing import Any

from distributed import Client
from distributed.comm import CommClosedError

from executive.campaign.execution.fingerprint import (
    Fingerprint,
    differences,
    lacking,
    local_fingerprint,
)
from executive.campaign.execution.worker_run import introduce
from executive.errors import ConfigError


class ClusterError(ConfigError):
    """The cluster cannot do the campaign's work; no run counts as failed by that."""


_PATIENCE_S = 60.0  # with a worker that does not answer; it is asked again


@dataclass(frozen=True, slots=True)
class AdmittedWorker:
    """A worker whose installation equals that of this process.

    Attributes:
        address: Its address in the cluster.
        process: Host and process, see `introduce`.
        cache: Host and folder of its inputs.
        threads: Number of runs that it takes side by side.
        lacks: Plugins of this process that it lacks, which matters only to runs that need them.
    """

    address: str
    process: str
    cache: str
    threads: int
    lacks: tuple[str, ...]


class ClusterWorkers:
    """Admits workers as they come, and forgets those that are gone.

    Each worker is asked in a thread of its own, so that one that dies or hangs delays nobody.
    """

    def __init__(self, client: Client, scheduler: str) -> None:
        self._client = client
        self._scheduler = scheduler
        self._asked: set[str] = set()
        self._answers: SimpleQueue[tuple[str, Any]] = SimpleQueue()
        self.admitted: dict[str, AdmittedWorker] = {}

    @property
    def are_new(self) -> bool:
        """Whether some workers have not introduced themselves yet."""
        return bool(self._asked)

    def look(self) -> frozenset[str]:
        """Ask the scheduler which workers there are, admit new ones, and return who is gone.

        Raises:
            ClusterError: If the scheduler is gone, or a new worker has another installation: the
                message names the worker, what differs, and the cure.
        """
        threads = self._threads()
        gone = frozenset(self.admitted) - frozenset(threads)
        for address in gone:
            del self.admitted[address]
        for address in frozenset(threads) - frozenset(self.admitted) - self._asked:
            self._asked.add(address)
            Thread(target=self._ask, args=(address,), daemon=True).start()
        self._admit(threads)
        return gone

    def dismiss(self, address: str) -> None:
        """Forget a worker that behaves as another process; it is met anew with the next look."""
        self.admitted.pop(address, None)

    def _threads(self) -> Mapping[str, int]:
        try:
            if self._client.status != "running":
                raise ConnectionError(f"the connection is {self._client.status}")
            return dict(self._client.nthreads())
        except OSError as error:
            raise ClusterError(
                f"the scheduler {self._scheduler} does not answer any more ({error}). Runs that "
                "have ended are kept; start the scheduler and workers again, and go on with "
                "--resume"
            ) from error

    def _ask(self, address: str) -> None:
        """Ask one worker who it is; its answer may be an error."""
        try:
            answers = self._client.run(
                introduce, workers=[address], on_error="return", callback_timeout=_PATIENCE_S
            )
            self._answers.put((address, answers[address]))
        except Exception as error:  # whatever it is, it is the answer
            self._answers.put((address, error))

    def _admit(self, threads: Mapping[str, int]) -> None:
        refusals = []
        while not self._answers.empty():
            address, answer = self._answers.get()
            self._asked.discard(address)
            if address not in threads:
                continue
            if has_left(answer):  # it is met anew, if it is still there
                continue
            there, problem = _judged(answer)
            if there is None:
                refusals.append(f"worker {address}: {problem}")
                continue
            lacks = lacking(local_fingerprint(), there)
            self.admitted[address] = AdmittedWorker(
                address, answer["process"], answer["cache"], threads[address], lacks
            )
        if refusals:
            raise ClusterError(
                f"results of {len(refusals)} of {len(threads)} workers would not be comparable "
                "with those of this computer:\n  " + "\n  ".join(refusals) + "\nInstall the same "
                "packages there as here, start these workers again, and go on with --resume"
            )


def has_left(answer: object) -> bool:
    """Return whether a worker gave no answer because it is gone since it was asked.

    `distributed` says by a bare OSError that it could not connect.
    """
    if isinstance(answer, CommClosedError | ConnectionError | TimeoutError):
        return True
    return type(answer) is OSError and answer.errno is None


def _judged(answer: Any) -> tuple[Fingerprint | None, str]:
    """Return the fingerprint of a worker, or None and how it differs from that of this process."""
    if isinstance(answer, Exception):
        said = f"{type(answer).__name__}: {answer}"
        return None, f"it did not answer as this version of executive does ({said})"
    try:
        there = Fingerprint(**answer["fingerprint"])
    except (TypeError, KeyError):
        return None, "its version of executive states other things of itself"
    difference = "; ".join(differences(local_fingerprint(), there))
    return (None, difference) if difference else (there, "")
