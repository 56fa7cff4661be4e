"""The smoother's process: answers, dies, hangs, and is replaced."""

import os
import signal
import time
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest

from plugins.estimation.dual_graph_settings import DualGraphSettings
from plugins.estimation.graph_estimate import Estimate
from plugins.estimation.graph_measurements import Fix
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import Inertial, InertialState
from plugins.estimation.smoother_process import InlineSmoother, ProcessSmoother
from plugins.estimation.smoother_settings import SmootherSettings

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81)
PATIENCE_S = 150.0  # a child imports for a second, on a busy machine for many


class Rest:
    """An IMU at rest at the origin with an antenna 1 m ahead, sampled for as long as is asked."""

    def __init__(self) -> None:
        self.k = 0
        z = np.zeros(3)
        self.state = InertialState(self.sample(), np.eye(3), z, z, z, z)
        self.covariance = 1e-4 * np.eye(15)

    def sample(self) -> Inertial:
        return Inertial(self.k / 100, np.zeros(3), np.array([0, 0, 9.81]), 0.01)

    def feed(self, host) -> Estimate | None:
        self.k += 1
        if self.k % 5 == 0:
            arm = np.array([1.0, 0, 0])
            host.add(Fix(self.k / 100, "gnss_left", arm, arm, 1e-4 * np.eye(3)))
        return host.add_sample(self.sample())

    def feed_until_answered(self, host) -> Estimate:
        deadline_s = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline_s:
            estimate = self.feed(host)
            if estimate is not None:
                return estimate
            time.sleep(0.01)
        raise TimeoutError("no estimate")


@pytest.fixture
def host() -> Iterator[ProcessSmoother]:
    host = ProcessSmoother(SmootherSettings(), NOISE, answer_within_s=1.0)
    yield host
    host.close()


def feed_until_a_spare_is_ready(rest, host) -> None:
    deadline_s = time.monotonic() + PATIENCE_S
    while host.spare is None or not is_ready(host.spare):
        rest.feed_until_answered(host)
        if time.monotonic() > deadline_s:
            raise TimeoutError("no spare")


def is_ready(spare) -> bool:
    spare.receive()
    return spare.is_idle


def watched(child) -> list[object]:
    """Return a list that grows by the start of each batch that the child is sent."""
    starts, send = [], child.send

    def sending(start, samples, measurements):
        starts.append(start)
        send(start, samples, measurements)

    child.send = sending
    return starts


def test_a_child_that_is_killed_is_replaced_at_the_next_sample_by_one_that_is_ready(host) -> None:
    rest = Rest()
    host.begin(rest.state, rest.covariance)
    before = rest.feed_until_answered(host)
    np.testing.assert_allclose(before.state.p_map_imu, np.zeros(3), atol=1e-3)
    feed_until_a_spare_is_ready(rest, host)
    spare, sent = host.spare, watched(host.spare)
    host.child.process.kill()
    host.child.process.join()
    for _ in range(3):  # an answer may still be in the pipe, then its end is met, then the spare is sent to
        rest.feed(host)
    assert host.restarts == 1
    assert host.child is spare
    assert sent[0] is not None  # it is at work already, from the last estimate: what remains is one update
    after = rest.feed_until_answered(host)
    assert after.state.stamp_s > before.state.stamp_s
    np.testing.assert_allclose(after.state.p_map_imu, np.zeros(3), atol=1e-3)


def test_a_child_that_hangs_is_replaced_when_its_time_is_up(host, monkeypatch) -> None:
    assert DualGraphSettings().answer_within_s <= 1.0  # so that with one update it is back within two seconds
    rest = Rest()
    host.begin(rest.state, rest.covariance)
    before = rest.feed_until_answered(host)
    feed_until_a_spare_is_ready(rest, host)
    clock = SimpleNamespace(now_s=time.monotonic())
    monkeypatch.setattr("plugins.estimation.smoother_child.time", SimpleNamespace(monotonic=lambda: clock.now_s))
    os.kill(host.child.process.pid, signal.SIGSTOP)
    spare, hung, sent = host.spare, host.child, watched(host.spare)
    for _ in range(40):
        rest.feed(host)
    clock.now_s += 0.99
    rest.feed(host)
    assert host.child is hung
    clock.now_s += 0.02
    rest.feed(host)
    assert host.restarts == 1
    assert host.child is spare
    rest.feed(host)
    assert sent[0] is not None
    monkeypatch.undo()
    assert rest.feed_until_answered(host).state.stamp_s > before.state.stamp_s


def test_a_new_beginning_drops_answers_to_the_old_one(host) -> None:
    rest = Rest()
    host.begin(rest.state, rest.covariance)
    rest.feed_until_answered(host)
    moved = InertialState(rest.sample(), np.eye(3), np.array([5.0, 0, 0]), *(np.zeros(3) for _ in range(3)))
    host.begin(moved, 1e-8 * np.eye(15))
    deadline_s = time.monotonic() + PATIENCE_S
    estimate = None
    while estimate is None and time.monotonic() < deadline_s:
        rest.k += 1
        estimate = host.add_sample(rest.sample())
        time.sleep(0.01)
    np.testing.assert_allclose(estimate.state.p_map_imu, [5, 0, 0], atol=1e-3)


def test_in_line_each_fix_is_answered_at_the_sample_that_reaches_it() -> None:
    rest = Rest()
    host = InlineSmoother(SmootherSettings(), NOISE)
    host.begin(rest.state, rest.covariance)
    answered = [rest.k for _ in range(50) if rest.feed(host) is not None]
    assert answered == list(range(5, 51, 5))
    host.close()
