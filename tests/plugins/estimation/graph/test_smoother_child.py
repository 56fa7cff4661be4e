"""The work of the smoother's process, done in this one: a pipe and the shared block."""

from multiprocessing import Pipe
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph import smoother_child
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.smoother_child import SmootherChild, Start
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.layout import ANSWERS, LIVE, SAMPLES
from executive_plugins.estimation.live.packing import unpacked

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
UP = np.array([0.0, 0.0, 9.81])
Z = np.zeros(3)


class Block:
    """The block of one process, as the parent writes it; a sample every 10 ms."""

    def __init__(self) -> None:
        self.memory = bytearray(LIVE.itemsize)
        self.rows = np.frombuffer(self.memory, LIVE, 1)
        self.ours, theirs = Pipe()
        self.work = smoother_child._Work(theirs, self.memory, SmootherSettings(), NOISE)

    def publish(self, count: int) -> None:
        row = self.rows[0]
        for number in range(int(row["published"]), int(row["published"]) + count):
            sample = row["samples"][number % SAMPLES]
            sample["stamp_s"], sample["since_last_s"] = (number + 1) / 100, 0.01
            sample["rate"], sample["force"] = Z, UP
        self.rows["published"] += count

    def start(self, first_sample: int = 0, epoch: int = 1) -> Start:
        sample = Inertial(first_sample / 100, Z, UP, 0.01)
        state = InertialState(sample, np.eye(3), Z, Z, Z, Z)
        return Start(epoch, GraphEstimate(state, 1e-4 * np.eye(15)), first_sample)

    def fix(self, stamp_s: float, off_m: float = 0.0) -> Fix:
        return Fix(stamp_s, "left", Z, np.array([off_m, 0.0, 0.0]), 1e-4 * np.eye(3))

    def answer(self) -> np.ndarray:
        number = int(self.rows["answered"][0]) % ANSWERS
        return self.rows["answers"][0][number : number + 1]


def test_a_spare_process_writes_nothing() -> None:
    block = Block()
    block.publish(20)
    block.work.take([block.fix(0.1)])
    block.work.update()
    assert block.rows["answered"][0] == block.rows["handled"][0] == 0
    assert block.work.timeout_s == 0.05


def test_a_fix_is_answered_once_its_sample_is_published() -> None:
    block = Block()
    block.work.take([block.start(epoch=7), block.fix(0.1)])
    block.work.update()
    assert block.rows["handled"][0] == 1
    assert block.rows["answered"][0] == 0
    assert block.work.timeout_s == 0.001  # it waits for a sample
    block.publish(10)
    block.work.update()
    assert block.rows["answered"][0] == 1
    assert block.work.timeout_s == 0.05
    state, P = unpacked(block.answer())
    assert state.stamp_s == 0.1
    assert state.p_map_imu == pytest.approx(Z, abs=1e-3)
    assert np.diag(P)[:3].max() < 1e-3
    assert (block.answer()["epoch"][0], block.answer()["messages"][0]) == (7, 0)
    block.work.update()
    assert block.rows["answered"][0] == 1  # there is nothing new
    assert not block.ours.poll(0)


def test_a_start_in_the_middle_reads_the_samples_after_it() -> None:
    block = Block()
    block.publish(5000)  # more than the ring holds
    block.work.take([block.start(4980)])
    block.publish(20)
    block.work.take([block.fix(50.2)])
    block.work.update()
    assert block.rows["handled"][0] == 2
    assert unpacked(block.answer())[0].stamp_s == 50.2


def test_answers_are_written_round_the_ring() -> None:
    block = Block()
    block.work.take([block.start()])
    for k in range(1, ANSWERS + 4):
        block.publish(5)
        block.work.take([block.fix(5 * k / 100)])
        block.work.update()
        assert block.rows["answered"][0] == k
        assert block.answer()["sample"]["stamp_s"][0] == pytest.approx(0.05 * k)


def test_a_refusal_is_sent_before_the_answer_that_counts_it() -> None:
    block = Block()
    block.publish(30)
    block.work.take([block.start(), block.fix(0.1, off_m=5.0), block.fix(0.2)])
    block.work.update()
    changes, refused = block.ours.recv()
    assert refused == {"left: outlier": 1}
    assert [change.after for change in changes] == ["SUSPECT", "GLOBAL"]
    assert block.answer()["messages"][0] == 1


def test_an_estimate_that_is_not_finite_is_not_published(monkeypatch) -> None:
    block = Block()
    block.publish(30)
    monkeypatch.setattr(smoother_child, "is_finite", lambda row: False)
    block.work.take([block.start(), block.fix(0.1, off_m=5.0)])
    block.work.update()
    assert block.rows["answered"][0] == 0
    assert not block.ours.poll(0)


def test_the_process_ends_when_it_is_told(monkeypatch) -> None:
    monkeypatch.setattr(smoother_child.signal, "signal", lambda *_: None)
    ours, theirs = Pipe()
    block = Block()
    block.publish(10)
    ours.send([block.start(), block.fix(0.1)])
    ours.send(None)
    smoother_child._serve(theirs, block.memory, SmootherSettings(), NOISE)
    assert ours.recv() is True
    assert (block.rows["handled"][0], block.rows["answered"][0]) == (1, 1)


def test_the_process_ends_when_its_parent_is_gone(monkeypatch) -> None:
    monkeypatch.setattr(smoother_child.signal, "signal", lambda *_: None)
    ours, theirs = Pipe()
    ours.close()
    block = Block()
    smoother_child._serve(theirs, block.memory, SmootherSettings(), NOISE)
    assert block.rows["handled"][0] == 0


class _Process:
    """A process that is not started."""

    def __init__(self, **_: object) -> None:
        self.was_killed, self.joined_s = False, []

    def start(self) -> None:
        pass

    def is_alive(self) -> bool:
        return True

    def join(self, timeout: float | None = None) -> None:
        self.joined_s.append(timeout)

    def kill(self) -> None:
        self.was_killed = True


@pytest.fixture
def child(monkeypatch):
    """Return a child whose process does nothing, the other end of its pipe, and its clock."""
    ends = Pipe()
    context = SimpleNamespace(Pipe=lambda: (ends[0], SimpleNamespace(close=lambda: None)))
    context.Process = _Process
    clock = SimpleNamespace(now_s=100.0)
    monkeypatch.setattr(smoother_child.multiprocessing, "get_context", lambda _: context)
    monkeypatch.setattr(smoother_child, "time", SimpleNamespace(monotonic=lambda: clock.now_s))
    return SmootherChild(SmootherSettings(), NOISE, bytearray(LIVE.itemsize)), ends[1], clock


def test_a_child_is_ready_once_it_says_so(child) -> None:
    one, theirs, clock = child
    assert not one.is_ready
    theirs.send(True)
    assert one.is_ready
    clock.now_s += 1000.0
    assert one.is_ready
    one.send(["batch"])
    assert theirs.recv() == ["batch"]
    theirs.send(((), {"left: outlier": 1}))
    assert one.messages() == ((), {"left: outlier": 1})


def test_a_child_that_does_not_start_is_told_after_a_minute(child) -> None:
    one, _, clock = child
    clock.now_s += 59.9
    assert not one.is_ready
    clock.now_s += 0.2
    with pytest.raises(OSError, match="the smoother's process does not start"):
        _ = one.is_ready


def test_a_child_is_asked_to_end_only_when_it_listens_and_is_killed_in_any_case(child) -> None:
    one, theirs, _ = child
    theirs.send(True)
    assert one.is_ready
    one.close()
    assert theirs.recv() is None
    assert one.process.was_killed
    assert one.process.joined_s == [1.0, None]


def test_a_child_that_is_not_ready_is_killed_without_waiting(child) -> None:
    one, theirs, _ = child
    one.close()
    with pytest.raises(EOFError):
        theirs.recv()
    assert one.process.was_killed
    assert one.process.joined_s == [None]
