"""What the host of a graph sends, awaits and gives up, with a process that the test plays."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.mapping import graph_host
from executive_plugins.mapping.graph_host import ProcessGraph
from executive_plugins.mapping.pair_graph import PairNode
from executive_plugins.mapping.pose_constraint import PoseConstraint

ANSWER_S = 2.0


class Child:
    """A process and the host's end of its pipe.

    Attributes:
        sent: What it was sent, and `answers` what it has sent.
        left_s: How long it was waited for at its end.
    """

    def __init__(self) -> None:
        self.sent: list[list[PairNode]] = []
        self.answers: list[object] = []
        self.is_dead, self.is_closed = False, False
        self.left_s: list[float | None] = []

    def poll(self) -> bool:
        return self.is_dead or bool(self.answers)

    def recv(self) -> object:
        if self.is_dead:
            raise EOFError
        return self.answers.pop(0)

    def send(self, batch: list[PairNode]) -> None:
        if self.is_dead:
            raise BrokenPipeError
        self.sent.append(list(batch))

    def close(self) -> None:
        self.is_closed = True

    def start(self) -> None:
        pass

    def is_alive(self) -> bool:
        return not self.is_dead

    def kill(self) -> None:
        self.is_dead = True

    def join(self, timeout_s: float | None = None) -> None:
        self.left_s.append(timeout_s)


@pytest.fixture
def clock(monkeypatch) -> SimpleNamespace:
    found = SimpleNamespace(now_s=50.0)
    monkeypatch.setattr(graph_host, "time", SimpleNamespace(monotonic=lambda: found.now_s))
    return found


@pytest.fixture
def children(monkeypatch, clock) -> list[Child]:
    """All processes, the newest last."""
    made: list[Child] = []

    def pipe() -> tuple[Child, SimpleNamespace]:
        made.append(Child())
        return made[-1], SimpleNamespace(close=lambda: None)

    context = SimpleNamespace(Pipe=pipe, Process=lambda **_: made[-1])
    monkeypatch.setattr(
        graph_host, "multiprocessing", SimpleNamespace(get_context=lambda _: context)
    )
    return made


@pytest.fixture
def host(children) -> ProcessGraph:
    return ProcessGraph(20, ANSWER_S)


def node(number: int) -> PairNode:
    return PairNode(number, np.eye(4), PoseConstraint(np.eye(4), np.eye(6)), False, None)


def numbers(batches: list[list[PairNode]]) -> list[list[int]]:
    return [[one.number for one in batch] for batch in batches]


def test_nothing_is_sent_before_the_process_is_ready_and_then_all_at_once(host, children) -> None:
    for k in range(3):
        host.add(node(k))
        assert host.take() is None
    assert children[0].sent == []
    children[0].answers.append(None)
    assert host.take() is None
    assert numbers(children[0].sent) == [[0, 1, 2]]


def test_one_batch_is_under_way_at_a_time(host, children) -> None:
    (child,) = children
    child.answers.append(None)
    host.add(node(0))
    host.take()
    host.add(node(1))
    host.add(node(2))
    assert host.take() is None
    assert numbers(child.sent) == [[0]]
    child.answers.append("poses")
    assert host.take() == "poses"
    assert numbers(child.sent) == [[0], [1, 2]]
    assert host.take() is None


@pytest.mark.parametrize(("wait_s", "restarts"), [(1.99, 0), (2.01, 1)])
def test_an_answer_that_takes_too_long_costs_the_process_and_no_node(
    host, children, clock, wait_s: float, restarts: int
) -> None:
    children[0].answers.append(None)
    host.add(node(0))
    host.add(node(1))
    host.take()
    host.add(node(2))
    clock.now_s += wait_s
    assert host.take() is None
    assert host.restarts == restarts
    if restarts:
        assert children[0].is_dead
        assert children[0].is_closed
    children[-1].answers.append(None)
    host.take()
    assert numbers(children[-1].sent) == ([[0, 1, 2]] if restarts else [[0, 1], [2]])


@pytest.mark.parametrize(("wait_s", "restarts"), [(29.0, 0), (31.0, 1)])
def test_a_process_may_import_for_half_a_minute(host, clock, wait_s: float, restarts: int) -> None:
    clock.now_s += wait_s
    host.take()
    assert host.restarts == restarts


def test_without_nodes_nothing_is_awaited(host, children, clock) -> None:
    children[0].answers.append(None)
    host.take()
    clock.now_s += 1000.0
    host.take()
    assert host.restarts == 0


def test_a_process_that_died_is_replaced(host, children) -> None:
    children[0].answers.append(None)
    host.take()
    children[0].is_dead = True
    host.add(node(7))
    assert host.take() is None
    assert host.restarts == 1
    children[1].answers.append(None)
    host.take()
    assert numbers(children[1].sent) == [[7]]


def test_an_idle_process_is_asked_to_end_and_given_a_second(host, children) -> None:
    (child,) = children
    child.answers.append(None)
    host.take()
    host.close()
    assert child.sent == [[]]  # an empty batch ends it
    assert child.left_s == [1.0, None]
    assert child.is_closed


def test_a_process_that_is_at_work_is_ended_at_once(host, children) -> None:
    host.close()
    assert children[0].sent == []
    assert children[0].left_s == [None]
    assert children[0].is_dead
