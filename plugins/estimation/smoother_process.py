"""Where the smoother runs: beside the inertial path in a process of its own, or in line with it."""

import logging
import multiprocessing
import select
import signal
import time
from abc import ABC, abstractmethod
from collections import deque
from multiprocessing.connection import Connection

from executive.arrays import Float
from plugins.estimation.graph_estimate import Estimate
from plugins.estimation.graph_measurements import Measurement
from plugins.estimation.graph_smoother import GraphSmoother
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import Inertial, InertialState
from plugins.estimation.smoother_parcel import estimate_of, packed_estimate, packed_samples, samples_of
from plugins.estimation.smoother_settings import SmootherSettings

_log = logging.getLogger(__name__)
_LEAVE_S = 1.0  # time that a child is given to end by itself
_SPAWN_S = 30.0  # time that a child may take to import what it needs
_MOST_SAMPLES = 20  # that wait for a measurement to be sent along with

_Start = tuple[InertialState, Float]
_Batch = tuple[_Start | None, Float, list[Measurement]]


class SmootherHost(ABC):
    """Takes raw samples, gives estimates whenever there is a new one; never blocks for long."""

    @abstractmethod
    def begin(self, state: InertialState, covariance: Float) -> None:
        """Begin anew at a state, shape of the covariance (15, 15)."""

    @abstractmethod
    def add(self, measurement: Measurement) -> None:
        """Hand over a measurement."""

    @abstractmethod
    def add_sample(self, sample: Inertial) -> Estimate | None:
        """Hand over an inertial sample; return a new estimate, if there is one."""

    @abstractmethod
    def close(self) -> None:
        """Release what the host owns."""


class InlineSmoother(SmootherHost):
    """Updates at the sample that reaches a measurement: the same samples always give the same estimates."""

    def __init__(self, settings: SmootherSettings, noise: InertialNoise) -> None:
        self._settings = settings
        self._noise = noise

    def begin(self, state: InertialState, covariance: Float) -> None:
        self._smoother = GraphSmoother(self._settings, self._noise, state, covariance)

    def add(self, measurement: Measurement) -> None:
        self._smoother.add(measurement)

    def add_sample(self, sample: Inertial) -> Estimate | None:
        self._smoother.add_sample(sample)
        return self._smoother.update() if self._smoother.is_due else None

    def close(self) -> None:
        """Own nothing."""


class ProcessSmoother(SmootherHost):
    """Updates in a child process, for GTSAM holds the interpreter's lock through a whole update.

    One batch is under way at a time, so that a child which hangs never blocks the sender, and what has nothing to
    correct waits: an inertial sample by itself only asks whether there is an answer. A child that died, or does
    not answer in time by the wall clock, the only one that a hung child obeys, is replaced by one that begins at the
    last estimate.

    Attributes:
        restarts: Number of children that had to be replaced.
    """

    def __init__(self, settings: SmootherSettings, noise: InertialNoise, answer_within_s: float) -> None:
        self._settings = settings
        self._noise = noise
        self._answer_within_s = answer_within_s
        self.restarts = 0
        self._start: _Start | None = None
        self._last: _Start | None = None
        self._samples: list[Inertial] = []
        self._measurements: list[Measurement] = []
        self._since: deque[Inertial] = deque()  # samples newer than the last estimate, for the next child
        self._spawn()

    def _spawn(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self.child = context.Process(target=_serve, args=(theirs, self._settings, self._noise), daemon=True)
        self.child.start()
        theirs.close()
        self._answered = select.poll()
        self._answered.register(self._connection.fileno(), select.POLLIN)
        self._deadline_s: float | None = time.monotonic() + _SPAWN_S  # it answers once when it is ready

    def begin(self, state: InertialState, covariance: Float) -> None:
        self._start = self._last = (state, covariance)
        self._samples.clear()
        self._measurements.clear()
        self._since.clear()

    def add(self, measurement: Measurement) -> None:
        self._measurements.append(measurement)
        if self._deadline_s is None and self._samples and measurement.stamp_s <= self._samples[-1].stamp_s:
            try:
                self._send()
            except OSError:
                self._replace("died")

    def add_sample(self, sample: Inertial) -> Estimate | None:
        self._samples.append(sample)
        self._since.append(sample)
        try:
            estimate = self._receive()
            if self._deadline_s is None and (self._measurements or len(self._samples) >= _MOST_SAMPLES or self._start):
                self._send()
        except (EOFError, OSError):
            self._replace("died")
            return None
        if self._deadline_s is not None and time.monotonic() > self._deadline_s:
            self._replace("does not answer")
        return estimate

    def _receive(self) -> Estimate | None:
        """Return the estimate that the child has answered, if it has, and if it is of the present start."""
        if self._deadline_s is None or not self._answered.poll(0):
            return None
        estimate = estimate_of(self._connection.recv_bytes())
        self._deadline_s = None
        if estimate is None or self._start is not None:
            return None
        self._last = (estimate.state, estimate.covariance)
        while self._since and self._since[0].stamp_s <= estimate.state.stamp_s:
            self._since.popleft()
        return estimate

    def _send(self) -> None:
        if self._last is None:
            return
        self._connection.send((self._start, packed_samples(self._samples), self._measurements))
        self._start = None
        self._samples, self._measurements = [], []
        self._deadline_s = time.monotonic() + self._answer_within_s

    def _replace(self, reason: str) -> None:
        _log.warning("the smoother's process %s; a new one begins at the last estimate", reason)
        self.restarts += 1
        self._end()
        self._start = self._last
        self._samples = list(self._since)
        self._spawn()

    def _end(self) -> None:
        self._connection.close()
        self.child.kill()
        self.child.join()

    def close(self) -> None:
        if self._deadline_s is None and self.child.is_alive():
            self._connection.send(None)
            self.child.join(_LEAVE_S)
        self._end()


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
