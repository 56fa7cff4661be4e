"""One process that smooths: batches go in, packed estimates come out."""

import multiprocessing
import select
import signal
import time
from contextlib import suppress
from multiprocessing.connection import Connection

from executive.arrays import Float
from plugins.estimation.graph_estimate import Estimate
from plugins.estimation.graph_measurements import Measurement
from plugins.estimation.graph_smoother import GraphSmoother
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import Inertial, InertialState
from plugins.estimation.smoother_parcel import estimate_of, packed_estimate, packed_samples, samples_of
from plugins.estimation.smoother_settings import SmootherSettings

_LEAVE_S = 1.0  # time that a child is given to end by itself
_SPAWN_S = 60.0  # time that a child may take to import what it needs, on a machine that is busy

Start = tuple[InertialState, Float]
_Batch = tuple[Start | None, Float, list[Measurement]]


class SmootherChild:
    """A child process with one batch under way at most; it says once that it is ready.

    Attributes:
        process: The process.
    """

    def __init__(self, settings: SmootherSettings, noise: InertialNoise, answer_within_s: float) -> None:
        self._answer_within_s = answer_within_s
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, settings, noise), daemon=True)
        self.process.start()
        theirs.close()
        self._answered = select.poll()
        self._answered.register(self._connection.fileno(), select.POLLIN)
        self._deadline_s: float | None = time.monotonic() + _SPAWN_S

    @property
    def is_idle(self) -> bool:
        """Whether a batch may be sent."""
        return self._deadline_s is None

    @property
    def is_late(self) -> bool:
        """Whether it owes an answer for longer than it may, by the wall clock, the only one that a hung child obeys."""
        return self._deadline_s is not None and time.monotonic() > self._deadline_s

    def send(self, start: Start | None, samples: list[Inertial], measurements: list[Measurement]) -> None:
        """Hand over a batch.

        Raises:
            OSError: If it has died.
        """
        self._connection.send((start, packed_samples(samples), measurements))
        self._deadline_s = time.monotonic() + self._answer_within_s

    def receive(self) -> Estimate | None:
        """Return what it has answered, if it has; it is idle then.

        Raises:
            EOFError, OSError: If it has died, at work or idle.
        """
        if not self._answered.poll(0):
            return None
        estimate = estimate_of(self._connection.recv_bytes())
        self._deadline_s = None
        return estimate

    def wait(self, patience_s: float) -> None:
        """Wait until there is something to receive; for what has no clock to keep, such as a replay or a test."""
        if self._deadline_s is not None:
            self._answered.poll(1000 * patience_s)

    def close(self) -> None:
        """Ask it to leave, and end it if it does not."""
        if self.is_idle and self.process.is_alive():
            with suppress(OSError):  # it may have died just now
                self._connection.send(None)
            self.process.join(_LEAVE_S)
        self.kill()

    def kill(self) -> None:
        """End it at once."""
        self._connection.close()
        self.process.kill()
        self.process.join()


def _serve(connection: Connection, settings: SmootherSettings, noise: InertialNoise) -> None:
    """Answer each batch with an estimate, or None where it brought nothing new; end with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    smoother: GraphSmoother | None = None
    try:
        connection.send_bytes(packed_estimate(None))
        while True:
            batch: _Batch | None = connection.recv()
            if batch is None:
                return
            start, rows, measurements = batch
            if start is not None:
                smoother = GraphSmoother(settings, noise, *start)
            connection.send_bytes(packed_estimate(_updated(smoother, samples_of(rows), measurements)))
    except (EOFError, OSError):  # nobody is there any more
        return


def _updated(
    smoother: GraphSmoother | None, samples: list[Inertial], measurements: list[Measurement]
) -> Estimate | None:
    if smoother is None:
        return None
    for sample in samples:
        smoother.add_sample(sample)
    for measurement in measurements:
        smoother.add(measurement)
    return smoother.update() if smoother.is_due else None
