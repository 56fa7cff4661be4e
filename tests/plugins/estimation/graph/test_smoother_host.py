"""The host's book-keeping of its child, with a child that does only what the test says."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph import smoother_process
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.smoother_child import Start
from executive_plugins.estimation.graph.smoother_process import ProcessSmoother
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.layout import ANSWERS, SAMPLES
from executive_plugins.estimation.live.modes import Mode
from executive_plugins.estimation.live.packing import pack_into
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.chassis import TurnJoint

from executive.messages.imu import ImuSample

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
ANSWER_S = 0.5
UP = np.array([0.0, 0.0, 9.81])
STILL = np.zeros(3)


class Child:
    """A child process without a process.

    Attributes:
        batches: What it was sent; `told` are its messages that were not received yet.
    """

    def __init__(self) -> None:
        self.batches: list[list[object]] = []
        self.told: list[tuple[list[object], dict[str, int]]] = []
        self.is_ready, self.is_killed, self.is_closed = True, False, False
        self.waits = 0
        self.process = SimpleNamespace(join=self._wait)

    def _wait(self, timeout_s: float) -> None:
        assert 0 < timeout_s < 0.01  # a replay asks again soon
        self.waits += 1

    def send(self, batch: list[object]) -> None:
        if self.is_killed:
            raise BrokenPipeError
        self.batches.append(list(batch))

    def messages(self) -> tuple[list[object], dict[str, int]]:
        if not self.told:
            raise EOFError
        return self.told.pop(0)

    def kill(self) -> None:
        self.is_killed = True

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def clock(monkeypatch) -> SimpleNamespace:
    found = SimpleNamespace(now_s=100.0)
    monkeypatch.setattr(smoother_process, "time", SimpleNamespace(monotonic=lambda: found.now_s))
    return found


@pytest.fixture
def host(monkeypatch, clock) -> ProcessSmoother:
    monkeypatch.setattr(smoother_process, "SmootherChild", lambda *_: Child())
    return ProcessSmoother(SmootherSettings(), NOISE, ANSWER_S)


@pytest.fixture
def propagator(host, machine) -> LivePropagator:
    return LivePropagator(np.eye(4), TurnJoint(machine), NOISE, 5.0, host.memory)


def state_at(stamp_s: float) -> InertialState:
    return InertialState(Inertial(stamp_s, STILL, UP, 0.01), np.eye(3), *[STILL] * 4)


def begin(host, propagator, stamp_s: float = 0.0) -> None:
    host.begin(propagator, GraphEstimate(state_at(stamp_s), 1e-4 * np.eye(15)))


def sampled(host, propagator, k: int):
    sample = ImuSample(k / 100, "imu_cabin", STILL, UP)
    answered = propagator.step(sample.stamp_s, STILL, UP)
    return host.sampled(propagator, sample, 0.01, answered)


def fix(k: int = 1) -> Fix:
    return Fix(k / 100, "gnss_left", STILL, STILL, 1e-4 * np.eye(3))


def answer(host, epoch: int = 1, messages: int = 0, mode: Mode = Mode.GLOBAL) -> None:
    """Write an estimate into the block, as the child does."""
    number = int(host._block["answered"][0]) + 1
    row = host._block["answers"][0][number % ANSWERS : number % ANSWERS + 1]
    pack_into(row, Estimate(state_at(0.0), 1e-4 * np.eye(15), mode, (), {}))
    row["epoch"], row["messages"] = epoch, messages
    host._block["answered"][0] = number


def test_the_first_batch_is_the_start_and_a_spare_child_follows(host, propagator) -> None:
    first = host.child
    assert host.spare is None  # both would import at the same time
    begin(host, propagator)
    ((start,),) = first.batches
    assert isinstance(start, Start)
    assert (start.epoch, start.first_sample, propagator.epoch) == (1, 0, 1)
    assert host.spare is not None
    spare = host.spare
    host.add(fix())
    assert host.spare is spare
    sampled(host, propagator, 1)
    begin(host, propagator, 0.02)
    assert (first.batches[-1][0].epoch, first.batches[-1][0].first_sample) == (2, 1)
    host.close()
    assert first.is_closed
    assert spare.is_closed


def test_at_most_sixteen_batches_are_under_way_and_the_rest_follows_as_one(
    host, propagator
) -> None:
    begin(host, propagator)
    for k in range(20):
        host.add(fix(k))
    assert len(host.child.batches) == 16
    host._handled[0] = 1  # the child has handled one
    host.add(fix(20))
    assert len(host.child.batches) == 17
    assert [one.stamp_s for one in host.child.batches[-1]] == [k / 100 for k in range(15, 21)]


def test_what_is_measured_while_the_child_starts_is_sent_when_it_is_ready(host, propagator) -> None:
    host.child.is_ready = False
    begin(host, propagator)
    host.add(fix(1))
    assert host.child.batches == []
    host.child.is_ready = True
    host.add(fix(2))
    ((start, *fixes),) = host.child.batches
    assert isinstance(start, Start)
    assert [one.stamp_s for one in fixes] == [0.01, 0.02]


@pytest.mark.parametrize(("after_s", "restarts"), [(-0.001, 0), (0.001, 1)])
def test_a_child_has_its_time_and_a_hundredth_of_a_second_a_measurement(
    host, propagator, clock, after_s: float, restarts: int
) -> None:
    host.child.is_ready = False
    begin(host, propagator)
    for k in range(9):
        host.add(fix(k))
    host.child.is_ready = True
    host.add(fix(9))  # the start and ten measurements, in one batch
    clock.now_s += ANSWER_S + 0.11 + after_s
    sampled(host, propagator, 1)
    assert host.restarts == restarts


def test_progress_gives_a_child_its_time_again_and_all_answered_takes_the_deadline(
    host, propagator, clock
) -> None:
    begin(host, propagator)
    host.add(fix())
    host._handled[0] = 1
    clock.now_s += ANSWER_S + 0.1
    sampled(host, propagator, 1)  # one of two is handled: half a second more
    clock.now_s += ANSWER_S - 0.01
    sampled(host, propagator, 2)
    assert host.restarts == 0
    host._handled[0] = 2
    clock.now_s += 0.02
    sampled(host, propagator, 3)
    clock.now_s += 100.0
    sampled(host, propagator, 4)
    assert host.restarts == 0  # nothing is awaited
    host.add(fix(5))
    clock.now_s += ANSWER_S + 0.02
    sampled(host, propagator, 5)
    assert host.restarts == 1


def test_a_spare_child_goes_on_from_the_last_start_with_what_waits(host, propagator) -> None:
    begin(host, propagator)
    dead, spare = host.child, host.spare
    dead.is_killed = True
    host.add(fix(3))
    assert host.restarts == 1
    assert host.child is spare
    ((start, waiting),) = spare.batches
    assert (start.epoch, start.first.state.stamp_s) == (1, 0.0)
    assert waiting.stamp_s == 0.03
    assert host.spare not in (None, dead, spare)


def test_a_child_that_replaces_another_starts_at_the_last_estimate_and_the_sample_after_it(
    host, propagator
) -> None:
    begin(host, propagator)
    answer(host)
    for k in range(1, 6):
        sampled(host, propagator, k)
    host._block["answers"][0]["sample"]["stamp_s"][1] = 0.03  # the estimate is of the third
    host.child.is_killed = True
    host.add(fix(5))
    start = host.child.batches[0][0]
    assert (start.epoch, start.first.state.stamp_s, start.first_sample) == (1, 0.03, 3)


def test_a_child_that_replaces_another_knows_no_more_of_the_clock_than_the_start(
    host, propagator
) -> None:
    clock = ClockOffset(0.02, 0.05, np.full(15, 1e-4))
    agreeing = AgreeingClock(0.5, 0.1)
    host.begin(propagator, GraphEstimate(state_at(0.0), 1e-4 * np.eye(15), clock, agreeing))
    answer(host)
    host.child.is_killed = True
    host.add(fix(5))
    first = host.child.batches[0][0].first
    assert (first.clock.offset_s, first.clock.std_s, first.agreeing) == (0.02, 0.05, agreeing)
    assert not first.clock.cross.any()


def test_samples_that_the_ring_has_lost_are_not_asked_for(host, propagator) -> None:
    begin(host, propagator)
    host._published[0] = SAMPLES + 10
    host._block["samples"][0]["stamp_s"] = 1.0
    assert host._first_after(0.5) == 10
    assert host._first_after(1.0) == SAMPLES + 10
    host._published[0] = 7
    assert host._first_after(0.5) == 0


def test_an_estimate_of_an_earlier_start_is_no_start(host, propagator) -> None:
    begin(host, propagator)
    answer(host, epoch=1)
    begin(host, propagator, 9.0)
    host.child.is_killed = True
    host.add(fix())
    assert host.child.batches[0][0].first.state.stamp_s == 9.0


def test_messages_come_with_the_estimate_that_counts_them(host, propagator) -> None:
    begin(host, propagator)
    host.child.told = [(["one"], {"late": 1}), (["two"], {"late": 2, "far": 1}), (["three"], {})]
    assert sampled(host, propagator, 1) is None
    answer(host, messages=2)
    update = sampled(host, propagator, 2)
    assert update.mode is Mode.GLOBAL
    assert update.changes == ["one", "two"]
    assert update.refused == {"late": 3, "far": 1}
    assert sampled(host, propagator, 3) is None  # each estimate is told once
    other = next(mode for mode in Mode if mode is not Mode.GLOBAL)
    answer(host, messages=2, mode=other)
    update = sampled(host, propagator, 4)
    assert (update.mode, list(update.changes), dict(update.refused)) == (other, [], {})
    answer(host, messages=3)
    assert sampled(host, propagator, 5).changes == ["three"]
    answer(host, messages=4)  # its child died in between
    assert sampled(host, propagator, 6).changes == []
    assert host.restarts == 1


def test_an_answer_to_an_earlier_start_is_not_told(host, propagator) -> None:
    begin(host, propagator)
    begin(host, propagator)
    answer(host, epoch=1)
    assert sampled(host, propagator, 1) is None
    answer(host, epoch=2)
    assert sampled(host, propagator, 2) is not None


def test_a_replay_waits_until_all_is_handled_or_its_time_is_over(host, propagator, clock) -> None:
    begin(host, propagator)
    child = host.child

    def handle(timeout_s: float) -> None:
        clock.now_s += timeout_s
        if clock.now_s > 100.5:
            host._handled[0] = 1

    child.process = SimpleNamespace(join=handle)
    host.wait(0.3)
    assert clock.now_s == pytest.approx(100.3, abs=0.01)
    host.wait(10.0)
    assert clock.now_s == pytest.approx(100.5, abs=0.01)
    child.is_ready = False
    host.add(fix())
    child.is_ready = True
    host.wait(0.1)  # what waits is sent first
    assert len(child.batches) == 2
