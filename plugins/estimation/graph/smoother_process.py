"""Hosts of the smoother: in a separate process, or inline with the inertial samples."""

import logging
import time
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context

import numpy as np
from executive_plugins.estimation.gate.measurements import Measurement
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.smoother import GraphSmoother
from executive_plugins.estimation.graph.smoother_child import Batch, SmootherChild, Start
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.layout import ANSWERS, LIVE
from executive_plugins.estimation.live.modes import Mode, ModeChange
from executive_plugins.estimation.live.packing import MODES, packed, packed_estimate, unpacked
from executive_plugins.estimation.live.propagator import LivePropagator
from typing_extensions import Buffer

from executive.messages.imu import ImuSample

_log = logging.getLogger(__name__)
# Batches under way at a time: they fit into the pipe, so that a child that hangs does not block.
_MOST_BATCHES = 16
_MEASUREMENT_S = 0.01  # time that one measurement may take on a busy computer


@dataclass(frozen=True, slots=True, eq=False)
class SmootherUpdate:
    """The part of an estimate besides the state.

    Attributes:
        mode: Mode of the estimator.
        changes: Changes of the mode since the last update.
        refused: Number of measurements refused since then, by stream and reason.
    """

    mode: Mode
    changes: Sequence[ModeChange]
    refused: Mapping[str, int]


_MODE_ONLY = tuple(SmootherUpdate(mode, (), {}) for mode in MODES)


class SmootherHost(ABC):
    """Runs a smoother on samples and measurements, without blocking for long.

    Attributes:
        memory: Shared memory for the propagator's block; None if no other process reads it.
    """

    memory: Buffer | None = None

    @abstractmethod
    def begin(self, propagator: LivePropagator, first: GraphEstimate) -> None:
        """Start from an estimate, and set the propagator to it."""

    @abstractmethod
    def add(self, measurement: Measurement) -> None:
        """Hand over a measurement."""

    @abstractmethod
    def sampled(
        self, propagator: LivePropagator, sample: ImuSample, since_last_s: float, answered: int
    ) -> SmootherUpdate | None:
        """Handle a sample after the propagator has taken it; apply a new estimate if there is one.

        Args:
            propagator: The propagator.
            sample: The sample.
            since_last_s: Time since the one before [s].
            answered: The propagator's answer to the sample.
        """

    @abstractmethod
    def close(self) -> None:
        """Release all resources."""


class InlineSmoother(SmootherHost):
    """Updates at the sample that reaches a measurement, in the caller's thread.

    The result is deterministic: the same samples give the same estimates.
    """

    def __init__(self, settings: SmootherSettings, noise: InertialNoise) -> None:
        self._settings = settings
        self._noise = noise

    def begin(self, propagator: LivePropagator, first: GraphEstimate) -> None:
        self._smoother = GraphSmoother(self._settings, self._noise, first)
        propagator.take(packed(*first.reported()))

    def add(self, measurement: Measurement) -> None:
        self._smoother.add(measurement)

    def sampled(
        self, propagator: LivePropagator, sample: ImuSample, since_last_s: float, answered: int
    ) -> SmootherUpdate | None:
        rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
        estimate = self._updated(Inertial(sample.stamp_s, rate, force, since_last_s))
        if estimate is None:
            return None
        if not propagator.take(packed_estimate(estimate)):
            return SmootherUpdate(
                estimate.mode, estimate.changes, {**estimate.refused, "smoother: not finite": 1}
            )
        return SmootherUpdate(estimate.mode, estimate.changes, estimate.refused)

    def _updated(self, sample: Inertial) -> Estimate | None:
        """Hand over a sample; return the new estimate, if there is one."""
        self._smoother.add_sample(sample)
        return self._smoother.update() if self._smoother.is_due else None

    def close(self) -> None:
        """Do nothing: this host holds no resources."""


class ProcessSmoother(SmootherHost):
    """Updates in a child process, since GTSAM holds the interpreter's lock during a whole update.

    An inertial sample needs no system call: the child reads it from the shared block, and writes
    its estimates there. Only measurements are sent. A child that has died or does not answer in
    time is replaced by a spare child, which starts at the last estimate. The spare is started in
    advance, because the imports of a new process take seconds.

    Attributes:
        restarts: Number of children that were replaced.
    """

    def __init__(
        self, settings: SmootherSettings, noise: InertialNoise, answer_within_s: float
    ) -> None:
        self._settings = settings
        self._noise = noise
        self._answer_within_s = answer_within_s
        memory: Buffer = get_context("spawn").RawArray("b", LIVE.itemsize)
        self.memory = self._memory = memory
        self._block = np.frombuffer(memoryview(memory), LIVE, 1)
        self._published, self._handled = (
            _counter(memory, name) for name in ("published", "handled")
        )
        self.restarts = 0
        self._outbox: Batch = []
        self._begun: Start | None = None
        self._taken = self._messages = self._sent = self._seen = 0
        self._deadline_s: float | None = None
        self.child = self._spawned()
        self.spare: SmootherChild | None = None

    def _spawned(self) -> SmootherChild:
        return SmootherChild(self._settings, self._noise, self._memory)

    def begin(self, propagator: LivePropagator, first: GraphEstimate) -> None:
        epoch = 1 if self._begun is None else self._begun.epoch + 1
        self._begun = Start(epoch, first, propagator.samples)
        propagator.take(packed(*first.reported()))
        propagator.epoch = epoch
        self._outbox = [self._begun]
        self._send()

    def add(self, measurement: Measurement) -> None:
        self._outbox.append(measurement)
        self._send()

    def sampled(
        self, propagator: LivePropagator, sample: ImuSample, since_last_s: float, answered: int
    ) -> SmootherUpdate | None:
        self._published[0] = propagator.samples  # not before the sample is written
        if self._deadline_s is not None and time.monotonic() > self._deadline_s:
            self._check_progress()
        if answered == self._taken:
            return None
        self._taken = answered
        return self._update_of(*propagator.take_answer(answered))

    def _update_of(self, mode: int, messages: int) -> SmootherUpdate | None:
        """Return what came with an estimate; None if it belongs to an earlier start."""
        if mode < 0:
            return None
        if messages == self._messages:
            return _MODE_ONLY[mode]
        changes: list[ModeChange] = []
        refused: Counter[str] = Counter()
        try:
            while self._messages < messages:
                more, counts = self.child.messages()
                self._messages += 1
                changes.extend(more)
                refused.update(counts)
        except (EOFError, OSError):
            self._replace("died")
        return SmootherUpdate(MODES[mode], changes, refused)

    def _send(self) -> None:
        """Send the waiting measurements if the child is ready; start a spare child."""
        try:
            if not self.child.is_ready or self._sent - self._handled[0] >= _MOST_BATCHES:
                return
            self.child.send(self._outbox)
        except (EOFError, OSError):
            self._replace("died")
            return
        self._sent += 1
        if self._deadline_s is None:
            self._wait_for_answer(len(self._outbox))
        self._outbox = []
        if self.spare is None:  # not earlier, or both children would import at the same time
            self.spare = self._spawned()

    def _wait_for_answer(self, measurements: int = 0) -> None:
        """Set the child's deadline by the wall clock, which runs on while a child hangs.

        The time is extended for many measurements, as after the replacement of a child.
        """
        self._seen = self._handled[0]
        self._deadline_s = time.monotonic() + self._answer_within_s + _MEASUREMENT_S * measurements

    def _check_progress(self) -> None:
        handled = self._handled[0]
        if handled == self._sent:
            self._deadline_s = None
        elif handled > self._seen:
            self._wait_for_answer()
        else:
            self._replace("does not answer")

    def _replace(self, reason: str) -> None:
        _log.warning(
            "the smoother's process %s; another one continues from the last estimate", reason
        )
        self.restarts += 1
        self.child.kill()
        self._sent = self._handled[0] = self._messages = 0
        self._deadline_s = None
        waiting = [item for item in self._outbox if not isinstance(item, Start)]
        self._outbox = [*self._last_start(), *waiting]
        self.child, self.spare = self.spare or self._spawned(), None
        self._send()

    def _last_start(self) -> list[Start]:
        """Return the last estimate as a start; if there is none, the last start itself.

        What was learnt of the receiver's clock since is lost.
        """
        if self._begun is None:
            return []
        number = int(self._block["answered"][0]) % ANSWERS
        row = self._block["answers"][0][number : number + 1]
        if row["epoch"][0] != self._begun.epoch:
            return [self._begun]
        state, covariance = unpacked(row)
        clock = replace(self._begun.first.clock, cross=np.zeros(len(covariance)))
        first = replace(self._begun.first, state=state, covariance=covariance, clock=clock)
        return [Start(self._begun.epoch, first, self._first_after(state.stamp_s))]

    def _first_after(self, stamp_s: float) -> int:
        """Return the number of the first sample that is newer than a time."""
        first = self._published[0]
        samples = self._block["samples"][0]
        while (
            first > max(0, self._published[0] - len(samples))
            and samples[(first - 1) % len(samples)][0] > stamp_s
        ):
            first -= 1
        return int(first)

    def wait(self, timeout_s: float) -> None:
        """Wait until everything sent is handled, at most `timeout_s`; for replays and tests."""
        until_s = time.monotonic() + timeout_s
        while (self._outbox or self._handled[0] < self._sent) and time.monotonic() < until_s:
            if self._outbox:
                self._send()
            self.child.process.join(0.001)

    def close(self) -> None:
        for child in (self.child, self.spare):
            if child is not None:
                child.close()


def _counter(memory: Buffer, name: str) -> memoryview:
    """Return one number of the block as a memory view.

    Python reads and writes it in one access, in program order.
    """
    offset = LIVE.fields[name][1]  # type: ignore[index]
    return memoryview(np.frombuffer(memoryview(memory), np.uint8)[offset : offset + 8]).cast("q")  # type: ignore[arg-type]
