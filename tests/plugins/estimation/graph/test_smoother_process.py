"""The smoother's process: it answers, dies, hangs, and is replaced."""

import os
import signal
import time
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import DualGraphSettings, SmootherSettings
from executive_plugins.estimation.graph.smoother_child import Start
from executive_plugins.estimation.graph.smoother_process import (
    InlineSmoother,
    ProcessSmoother,
    SmootherHost,
    SmootherUpdate,
)
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.chassis import TurnJoint

from executive.messages.imu import ImuSample

NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)
PATIENCE_S = 150.0  # a child imports for a second, on a busy machine for many


class Rest:
    """An IMU at rest at the origin with an antenna 1 m ahead, sampled for as long as is asked."""

    def __init__(self, host: SmootherHost, machine) -> None:
        self.k = 0
        self.host = host
        self.propagator = LivePropagator(np.eye(4), TurnJoint(machine), NOISE, 5.0, host.memory)
        self.begin(np.zeros(3))

    def begin(self, p: np.ndarray) -> None:
        z = np.zeros(3)
        sample = Inertial(self.k / 100, z, np.array([0, 0, 9.81]), 0.01)
        state = InertialState(sample, np.eye(3), p, z, z, z)
        self.host.begin(self.propagator, GraphEstimate(state, 1e-4 * np.eye(15)))

    def feed(self, has_fixes: bool = True) -> SmootherUpdate | None:
        self.k += 1
        if has_fixes and self.k % 5 == 0:
            arm = np.array([1.0, 0, 0])
            self.host.add(Fix(self.k / 100, "gnss_left", arm, arm, 1e-4 * np.eye(3)))
        sample = ImuSample(self.k / 100, "imu_cabin", np.zeros(3), np.array([0, 0, 9.81]))
        answered = self.propagator.step(
            sample.stamp_s, sample.angular_velocity_rad_s, sample.specific_force_m_s2
        )
        return self.host.sampled(self.propagator, sample, 0.01, answered)

    def feed_until(self, is_so, has_fixes: bool = True) -> None:
        deadline_s = time.monotonic() + PATIENCE_S
        while not is_so(self.feed(has_fixes)):
            if time.monotonic() > deadline_s:
                raise TimeoutError("it never came to be so")
            time.sleep(0.01)

    def feed_until_answered(self) -> None:
        self.feed_until(lambda news: news is not None)

    @property
    def p(self) -> np.ndarray:
        return self.propagator.state("").T_map_cabin[:3, 3]


@pytest.fixture
def host() -> Iterator[ProcessSmoother]:
    host = ProcessSmoother(SmootherSettings(), NOISE, answer_within_s=1.0)
    yield host
    host.close()


@pytest.fixture
def rest(host, machine) -> Rest:
    return Rest(host, machine)


def feed_until_a_spare_is_ready(rest) -> None:
    rest.feed_until(lambda _: rest.host.spare is not None and rest.host.spare.is_ready)
    rest.host.wait(PATIENCE_S)


def watched(child) -> list[object]:
    """Return a list that grows by what the child is sent."""
    sent, send = [], child.send

    def sending(batch):
        sent.extend(batch)
        send(batch)

    child.send = sending
    return sent


def test_a_child_that_is_killed_is_replaced_at_the_next_measurement_by_one_that_is_ready(
    rest, host
) -> None:
    rest.feed_until_answered()
    np.testing.assert_allclose(rest.p, np.zeros(3), atol=1e-3)
    feed_until_a_spare_is_ready(rest)
    spare, sent = host.spare, watched(host.spare)
    host.child.process.kill()
    host.child.process.join()
    for _ in range(5):
        rest.feed()
    assert host.restarts == 1
    assert host.child is spare
    assert isinstance(
        sent[0], Start
    )  # it is at work already, from the last estimate: what remains is one update
    assert rest.k / 100 - sent[0].first.state.stamp_s < 0.2
    rest.feed_until_answered()
    np.testing.assert_allclose(rest.p, np.zeros(3), atol=1e-3)


def test_a_child_that_hangs_is_replaced_after_its_deadline(rest, host, monkeypatch) -> None:
    assert (
        DualGraphSettings().answer_within_s <= 1.0
    )  # so that with one update it is back within two seconds
    rest.feed_until_answered()
    feed_until_a_spare_is_ready(rest)
    clock = SimpleNamespace(now_s=time.monotonic() + 10.0)
    monkeypatch.setattr(
        "executive_plugins.estimation.graph.smoother_process.time",
        SimpleNamespace(monotonic=lambda: clock.now_s),
    )
    rest.feed(has_fixes=False)  # all is answered: no deadline is left
    os.kill(host.child.process.pid, signal.SIGSTOP)
    spare, hung, sent = host.spare, host.child, watched(host.spare)
    for _ in range(40):
        rest.feed()
    clock.now_s += 0.99
    rest.feed()
    assert host.child is hung
    clock.now_s += 0.05
    rest.feed()
    assert host.restarts == 1
    assert host.child is spare
    assert isinstance(sent[0], Start)
    monkeypatch.undo()
    rest.feed_until_answered()
    np.testing.assert_allclose(rest.p, np.zeros(3), atol=1e-3)


def test_a_child_that_answers_is_never_replaced(rest, host, monkeypatch) -> None:
    rest.feed_until_answered()
    feed_until_a_spare_is_ready(rest)
    host.wait(PATIENCE_S)
    clock = SimpleNamespace(now_s=time.monotonic())  # a busy host's own second is no deadline
    stopped = SimpleNamespace(monotonic=lambda: clock.now_s)
    for _ in range(6):  # a deadline passes each time, with all answered or something new under way
        with monkeypatch.context() as patch:
            patch.setattr("executive_plugins.estimation.graph.smoother_process.time", stopped)
            for _ in range(5):
                rest.feed()
        host.wait(PATIENCE_S)
        clock.now_s += 1.5
    assert host.restarts == 0


def test_a_spare_child_does_not_disturb_the_active_one(rest, host) -> None:
    rest.feed_until_answered()
    feed_until_a_spare_is_ready(rest)
    handled = host._handled[0]
    assert handled > 0
    host.spare.process.join(0.3)  # time for the one in reserve to look around several times
    assert host._handled[0] >= handled


def test_without_measurements_the_child_still_reports_changes_of_mode(rest, host) -> None:
    rest.feed_until_answered()
    heard = []
    rest.feed_until(
        lambda news: heard.append(news) or (news is not None and news.changes), has_fixes=False
    )
    assert "no fix for" in heard[-1].changes[0].reason


def test_a_new_start_ignores_answers_to_the_old_one(rest, host) -> None:
    rest.feed_until_answered()
    rest.feed_until(lambda _: rest.k % 5 == 0)  # a fix is under way
    rest.begin(np.array([5.0, 0, 0]))
    for _ in range(3):
        rest.feed(has_fixes=False)
        host.wait(PATIENCE_S)
    rest.feed_until(lambda news: news is not None, has_fixes=False)
    np.testing.assert_allclose(rest.p, [5, 0, 0], atol=1e-2)


def test_in_line_each_fix_is_answered_at_the_sample_that_reaches_it(machine) -> None:
    host = InlineSmoother(SmootherSettings(), NOISE)
    rest = Rest(host, machine)
    answered = [rest.k for _ in range(50) if rest.feed() is not None]
    assert answered == list(range(5, 51, 5))
    host.close()
