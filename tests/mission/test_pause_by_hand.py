"""A pause by hand: when the machine stands, when time goes on, and who is told."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.clock import SimulatedClock
from executive.messages.joints import JointSample
from executive.mission import pause as pause_module
from executive.mission.pause import Pause

TICK_S = 0.05


class Robot:
    """Notes what it is told; its path is behind by some time after a pause."""

    def __init__(self) -> None:
        self.told: list[str] = []
        self.late_s = 0.0

    def stop(self) -> None:
        self.told.append("stop")

    def resume(self) -> None:
        self.told.append("resume")

    def behind_s(self) -> float:
        self.told.append("behind")
        return self.late_s

    def paused(self, now_s: float) -> None:
        self.told.append(f"paused at {now_s:g}")

    def resumed(self, now_s: float) -> None:
        self.told.append(f"resumed at {now_s:g}")


class Stand:
    def __init__(self, brake_s: float = 0.0) -> None:
        self.clock, self.robot, self.errors = SimulatedClock(), Robot(), []
        self.viewer = SimpleNamespace(paused=self.fail, resumed=lambda now_s: None)
        plugins = {"robot": self.robot, "viewing": self.viewer}
        self.pause = Pause(self.clock, plugins, lambda *given: self.errors.append(given), brake_s)
        for _ in range(10):
            self.clock.advance(TICK_S)

    def fail(self, now_s: float) -> None:
        raise ValueError("no ink")

    def rest(self, seconds: float) -> None:
        """Let samples of joints that stand come for a time."""
        for _ in range(round(seconds / TICK_S)):
            self.clock.advance(TICK_S)
            self.pause.watch(sample(self.clock.machine_s()))


def sample(stamp_s: float, speed: float = 0.0) -> JointSample:
    return JointSample(stamp_s, ("a",), np.zeros(1), np.full(1, speed), np.zeros(1))


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(pause_module, "wall_s", lambda: now[0])
    return now


def test_a_pause_stops_the_machine_and_time_and_tells_the_plugins(wall: list[float]) -> None:
    stand = Stand()
    pause = stand.pause
    assert not pause.is_on
    pause.begin()
    assert pause.is_on
    assert stand.robot.told == ["stop", "paused at 0.5"]
    ((capability, plugin, error),) = stand.errors
    assert (capability, plugin, str(error)) == ("viewing", stand.viewer, "no ink")
    stand.clock.advance(TICK_S)
    stand.clock.advance(TICK_S)
    wall[0] += 3.0
    assert pause.end() == pytest.approx(2 * TICK_S)
    assert not pause.is_on
    assert stand.robot.told[-1] == "resumed at 0.5"
    assert stand.clock.now_s() == 0.5
    report = pause.as_report()
    assert (report.count, report.machine_s, report.wall_s) == (1, 0.1, 3.0)
    pause.begin()
    wall[0] += 1.0
    assert pause.leave() == 0.0
    assert (pause.as_report().count, pause.as_report().wall_s) == (2, 4.0)
    assert pause.leave() == 0.0
    assert pause.as_report().wall_s == 4.0


@pytest.mark.parametrize("brake_s", [0.0, 2.0])
def test_nothing_goes_on_once_the_joints_stand_and_the_chassis_has_braked(
    wall: list[float], brake_s: float
) -> None:
    stand = Stand(brake_s)
    pause = stand.pause
    stand.rest(3.0)  # before a pause nothing is looked for
    pause.begin()
    pause.watch(None)
    assert not pause.is_still
    stand.rest(1.0)
    assert pause.stands == pause.is_still == (brake_s == 0.0)
    stand.rest(1.5)
    assert pause.is_still
    pause.end()
    assert not pause.is_still


def test_time_waits_until_the_machine_is_where_its_path_is(wall: list[float]) -> None:
    stand = Stand()
    pause = stand.pause
    assert not pause.must_wait(True)  # without a pause
    assert not pause.must_wait(False)
    assert stand.robot.told == []
    pause.begin()
    stand.rest(1.0)
    assert pause.stands
    assert not pause.must_wait(False)
    stand.robot.told, stand.robot.late_s = [], 2 * TICK_S
    assert pause.must_wait(True)
    assert stand.robot.told == ["behind", "resume"]
    assert not pause.stands
    stand.rest(TICK_S)
    assert not pause.stands  # it moves again
    assert pause.must_wait(True)
    stand.clock.advance(TICK_S)
    assert not pause.must_wait(True)
    assert stand.robot.told == ["behind", "resume"]  # once


def test_a_pause_that_is_to_last_after_all_stops_the_machine_again(wall: list[float]) -> None:
    stand = Stand()
    pause = stand.pause
    pause.begin()
    stand.robot.late_s = 1.0
    assert pause.must_wait(True)
    stand.robot.told = []
    assert not pause.must_wait(False)
    assert stand.robot.told == ["stop"]
    assert not pause.must_wait(False)
    assert stand.robot.told == ["stop"]
    stand.rest(1.0)
    assert pause.stands
    assert pause.must_wait(True)
    assert stand.robot.told == ["stop", "behind", "resume"]
