"""Where the smoother runs: beside the inertial path in a process of its own, or in line with it."""

import logging
from abc import ABC, abstractmethod
from collections import deque

from executive.arrays import Float
from plugins.estimation.graph_estimate import Estimate
from plugins.estimation.graph_measurements import Measurement
from plugins.estimation.graph_smoother import GraphSmoother
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import Inertial, InertialState
from plugins.estimation.smoother_child import SmootherChild, Start
from plugins.estimation.smoother_settings import SmootherSettings

_log = logging.getLogger(__name__)
_MOST_SAMPLES = 20  # that wait for a measurement to be sent along with


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
    not answer in time, is replaced by one that begins at the last estimate. It stands by: to begin with a new process
    would cost the seconds that its imports take.

    Attributes:
        restarts: Number of children that had to be replaced.
    """

    def __init__(self, settings: SmootherSettings, noise: InertialNoise, answer_within_s: float) -> None:
        self._settings = settings
        self._noise = noise
        self._answer_within_s = answer_within_s
        self.restarts = 0
        self._start: Start | None = None
        self._last: Start | None = None
        self._samples: list[Inertial] = []
        self._measurements: list[Measurement] = []
        self._since: deque[Inertial] = deque()  # samples newer than the last estimate, for the next child
        self.child = self._spawned()
        self.spare: SmootherChild | None = None

    def _spawned(self) -> SmootherChild:
        return SmootherChild(self._settings, self._noise, self._answer_within_s)

    def begin(self, state: InertialState, covariance: Float) -> None:
        self._start = self._last = (state, covariance)
        self._samples.clear()
        self._measurements.clear()
        self._since.clear()

    def add(self, measurement: Measurement) -> None:
        self._measurements.append(measurement)
        if self.child.is_idle and self._samples and measurement.stamp_s <= self._samples[-1].stamp_s:
            try:
                self._send()
            except OSError:
                self._replace("died")

    def add_sample(self, sample: Inertial) -> Estimate | None:
        self._samples.append(sample)
        self._since.append(sample)
        try:
            estimate = self._receive()
            if self.child.is_idle and (self._measurements or len(self._samples) >= _MOST_SAMPLES or self._start):
                self._send()
        except (EOFError, OSError):
            self._replace("died")
            return None
        if self.child.is_late:
            self._replace("does not answer")
        return estimate

    def _receive(self) -> Estimate | None:
        """Return the estimate that the child has answered, if it has, and if it is of the present start."""
        estimate = self.child.receive()
        if self.spare is None and self.child.is_idle:  # not before, for the two would import side by side
            self.spare = self._spawned()
        if estimate is None or self._start is not None:
            return None
        self._last = (estimate.state, estimate.covariance)
        while self._since and self._since[0].stamp_s <= estimate.state.stamp_s:
            self._since.popleft()
        return estimate

    def _send(self) -> None:
        if self._last is None:
            return
        start, samples, measurements = self._start, self._samples, self._measurements
        self._start, self._samples, self._measurements = None, [], []
        self.child.send(start, samples, measurements)

    def _replace(self, reason: str) -> None:
        _log.warning("the smoother's process %s; another one goes on from the last estimate", reason)
        self.restarts += 1
        self.child.kill()
        self._start = self._last
        self._samples = list(self._since)
        self.child, self.spare = self.spare or self._spawned(), None

    def close(self) -> None:
        for child in (self.child, self.spare):
            if child is not None:
                child.close()
