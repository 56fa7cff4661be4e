"""The child process that smooths.

Measurements are sent to it by a pipe. Samples and estimates are exchanged by shared memory.
"""

import multiprocessing
import signal
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection

import numpy as np
from executive_plugins.estimation.gate.measurements import Measurement
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.smoother import GraphSmoother
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.layout import ANSWERS, LIVE
from executive_plugins.estimation.live.modes import ModeChange
from executive_plugins.estimation.live.packing import is_finite, pack_into, samples_from
from typing_extensions import Buffer

_LEAVE_S = 1.0  # time for a child to end by itself
_SPAWN_S = 60.0  # time for a child to import its modules, on a busy computer
_IDLE_S = 0.05  # period of looking for samples while there are no measurements
_SOON_S = 0.001  # the same while a measurement waits for its sample


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """A state to start from.

    Attributes:
        epoch: Number of the start; estimates carry it.
        first: What it starts from.
        first_sample: Number of the first sample after it.
    """

    epoch: int
    first: GraphEstimate
    first_sample: int


Messages = tuple[Sequence[ModeChange], Mapping[str, int]]
Batch = list[Start | Measurement]


class SmootherChild:
    """A child process, which reports once that it is ready.

    Attributes:
        process: The process.
    """

    def __init__(self, settings: SmootherSettings, noise: InertialNoise, memory: Buffer) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self.process = context.Process(
            target=_serve, args=(theirs, memory, settings, noise), daemon=True
        )
        self.process.start()
        theirs.close()
        self._ready_by_s = time.monotonic() + _SPAWN_S
        self._is_ready = False

    @property
    def is_ready(self) -> bool:
        """Whether it accepts batches.

        Raises:
            EOFError, OSError: If the process has died, or takes too long to start.
        """
        if not self._is_ready and self._connection.poll(0):
            self._is_ready = self._connection.recv()
        if not self._is_ready and time.monotonic() > self._ready_by_s:
            raise OSError("the smoother's process does not start")
        return self._is_ready

    def send(self, batch: Batch) -> None:
        """Send a batch.

        Raises:
            OSError: If the process has died.
        """
        self._connection.send(batch)

    def messages(self) -> Messages:
        """Receive the next message of mode changes and refusals; call it only if one was sent.

        Raises:
            EOFError, OSError: If the process has died.
        """
        messages: Messages = self._connection.recv()
        return messages

    def close(self) -> None:
        """Ask the process to end, and kill it if it does not."""
        if self._is_ready and self.process.is_alive():
            with suppress(OSError):  # it may have died just now
                self._connection.send(None)
            self.process.join(_LEAVE_S)
        self.kill()

    def kill(self) -> None:
        """Kill the process."""
        self._connection.close()
        self.process.kill()
        self.process.join()


def _serve(
    connection: Connection, memory: Buffer, settings: SmootherSettings, noise: InertialNoise
) -> None:
    """Answer measurements with estimates until the parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    work = _Work(connection, memory, settings, noise)
    try:
        connection.send(True)
        while True:
            if connection.poll(work.timeout_s):
                batch: Batch | None = connection.recv()
                if batch is None:
                    return
                work.take(batch)
            work.update()
    except (EOFError, OSError):  # the parent has ended
        return


class _Work:
    """The smoother in the child, and its state of reading and writing the shared block."""

    def __init__(
        self,
        connection: Connection,
        memory: Buffer,
        settings: SmootherSettings,
        noise: InertialNoise,
    ) -> None:
        self._connection = connection
        self._block = np.frombuffer(memoryview(memory), LIVE, 1)
        self._made = (settings, noise)
        self._smoother: GraphSmoother | None = None
        self._epoch, self._read, self._messages, self._batches = 0, 0, 0, 0

    @property
    def timeout_s(self) -> float:
        """Time to wait for a batch before the next look for samples [s]."""
        return _SOON_S if self._smoother is not None and self._smoother.is_waiting else _IDLE_S

    def take(self, batch: Batch) -> None:
        self._batches += 1
        for item in batch:
            if isinstance(item, Start):
                self._smoother = GraphSmoother(*self._made, item.first)
                self._epoch, self._read = item.epoch, item.first_sample
            elif self._smoother is not None:
                self._smoother.add(item)

    def update(self) -> None:
        """Read the new samples, and write an estimate if there is anything new."""
        if self._smoother is not None:
            end = int(self._block["published"][0])
            for sample in samples_from(self._block, self._read, end):
                self._smoother.add_sample(sample)
            self._read = max(end, self._read)
            if self._smoother.is_due:
                self._answer(self._smoother.update())
            # A spare process has no smoother and must not write.
            self._block["handled"][0] = self._batches

    def _answer(self, estimate: Estimate) -> None:
        """Write the estimate, then count it; messages that do not fit are sent first."""
        number = int(self._block["answered"][0]) + 1
        row = self._block["answers"][0][number % ANSWERS : number % ANSWERS + 1]
        pack_into(row, estimate)
        if not is_finite(row):
            return
        if estimate.changes or estimate.refused:
            self._connection.send((estimate.changes, estimate.refused))
            self._messages += 1
        row["epoch"], row["messages"] = self._epoch, self._messages
        self._block["answered"][0] = number
