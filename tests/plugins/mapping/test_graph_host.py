"""A graph in a separate process gives the poses of an inline one, and survives the process."""

import os
import signal
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from executive_plugins.mapping.graph_host import InlineGraph, ProcessGraph
from executive_plugins.mapping.pair_graph import PairNode, Poses
from executive_plugins.mapping.pose_constraint import PoseConstraint

from executive.geometry.pose import pose

P = 1e-4 * np.eye(6)
STEP = pose(t=np.array([0.1, 0.0, 0.0]))


def node(number: int) -> PairNode:
    T = pose(t=np.array([0.1 * number, 0.0, 0.0]))
    return PairNode(
        number,
        T,
        PoseConstraint(T, P),
        number % 3 == 0,
        PoseConstraint(STEP, P) if number else None,
    )


@pytest.fixture(scope="module")
def beside() -> Iterator[ProcessGraph]:
    host = ProcessGraph(20, answer_within_s=20.0)
    yield host
    host.close()


def answered(host: ProcessGraph, is_enough: Callable[[Poses], bool]) -> Poses:
    for _ in range(6000):
        poses = host.take()
        if poses is not None and is_enough(poses):
            return poses
        time.sleep(0.01)
    raise AssertionError("no answer within a minute")


def end(poses: Poses) -> int:
    return poses.first + len(poses.T_map_cabin)


def test_its_poses_equal_those_of_the_inline_graph_also_after_the_process_died(
    beside: ProcessGraph, caplog: pytest.LogCaptureFixture
) -> None:
    inline = InlineGraph(20)
    for k in range(12):
        inline.add(node(k))
        beside.add(node(k))
    there = answered(beside, lambda poses: end(poses) == 12)
    here = inline.take()
    assert here is not None
    np.testing.assert_array_equal(there.T_map_cabin, here.T_map_cabin)
    assert inline.take() is None

    os.kill(beside.child.pid, signal.SIGKILL)
    beside.child.join()
    for k in range(12, 16):
        beside.add(node(k))
        beside.take()
    after = answered(beside, lambda poses: end(poses) == 16)
    assert beside.restarts == 1
    assert "died" in caplog.text
    np.testing.assert_allclose(after.T_map_cabin[-1], node(15).T_map_cabin, atol=1e-6)


def test_nodes_without_an_answer_are_sent_again(beside: ProcessGraph) -> None:
    beside.add(node(30))
    answered(beside, lambda poses: end(poses) == 31)
    os.kill(beside.child.pid, signal.SIGSTOP)
    beside.add(node(31))
    beside.take()  # sends the node, which the stopped process does not read
    os.kill(beside.child.pid, signal.SIGKILL)
    beside.child.join()
    beside.add(node(32))
    after = answered(beside, lambda poses: end(poses) == 33)
    assert after.first == 31
