"""In a pause mission time stands still, the machine is held, and the mission goes on as before."""

import threading

import pytest
from executive_plugins.robot.kinematic import KinematicRobot

from executive.events.mission import PauseEnded, PhaseChanged
from executive.journal import read_journal
from executive.machine.machine import load_machine
from executive.messages.command import Drive, MoveJaws
from executive.messages.joints import JointSample
from executive.mission.operator import Operator
from executive.mission.options import Options
from executive.mission.phase import Phase
from executive.mission.run import Run
from executive.tree.load import load_mission

HEAD = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
  objects: sqlite
"""
SWING = """
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - timeout: 12 s
        do:
          run: ScanSwing
          with: {angle: 60 deg, duration: 8 s}
      - wait: 2 s
"""


class PauseAt:
    """Asks for a pause at a mission time, and for its end so many ticks later."""

    def __init__(self, at_s, ticks):
        self.at_s, self.left = at_s, ticks
        self.speeds = []

    def __call__(self, mission):
        if not self.speeds and mission.clock.now_s() < self.at_s - 1e-9:
            return
        if not self.speeds:
            mission.toggle_pause()
        if self.left == 0:
            mission.toggle_pause()
        self.left -= 1
        self.speeds.append(abs(mission.services.joints().velocity).max())


def run(tmp_path, text, *, name="run", overrides=(), after_tick=lambda mission: None, **options):
    path = tmp_path / "dry.yaml"
    path.write_text(HEAD + text)
    made = Run(load_mission(str(path), overrides), Options(run_dir=tmp_path / name, **options))
    return made.execute(after_tick)


def entries(result):
    return list(read_journal(result.folder.journal))


def story(result):
    """Return what happened but for the pause."""
    return [
        (entry.tick, entry.time_s, entry.node, entry.kind, entry.event.payload())
        for entry in entries(result)
        if not isinstance(entry.event, PhaseChanged | PauseEnded)
    ]


@pytest.mark.parametrize("at_s", [2.0, 6.0, 9.3, 11.0, 12.0])
def test_a_mission_goes_on_after_a_pause_as_if_nothing_had_been(tmp_path, at_s):
    pause = PauseAt(at_s, ticks=80)
    undisturbed = run(tmp_path, SWING, name="undisturbed")
    result = run(tmp_path, SWING, after_tick=pause)
    assert result.report.outcome == "success", result.report.reason
    assert story(result) == story(undisturbed)
    assert result.report.pauses.count == 1


def test_the_machine_is_at_rest_in_a_pause(tmp_path):
    pause = PauseAt(6.0, ticks=80)
    run(tmp_path, SWING, after_tick=pause)
    assert pause.speeds[0] > 0.05
    assert pause.speeds[-2] < 0.01


def test_in_lock_step_a_longer_pause_changes_nothing(tmp_path):
    short = run(tmp_path, SWING, name="short", after_tick=PauseAt(6.0, ticks=60))
    long = run(tmp_path, SWING, name="long", after_tick=PauseAt(6.0, ticks=120))
    assert short.folder.journal.read_bytes() == long.folder.journal.read_bytes()


def test_plugins_are_told_of_a_pause_and_of_its_end(tmp_path, monkeypatch):
    told = []
    for verb in ("paused", "resumed"):
        monkeypatch.setattr(
            f"executive_plugins.mapping.voxel_map.VoxelMap.{verb}",
            lambda self, now_s, verb=verb: told.append((verb, now_s)),
            raising=False,
        )
    run(tmp_path, SWING, after_tick=PauseAt(6.0, ticks=60))
    assert [verb for verb, _ in told] == ["paused", "resumed"]
    assert told[0][1] == told[1][1] == pytest.approx(6.0, abs=0.051)


def test_a_path_that_was_cancelled_is_not_taken_up_after_a_pause(tmp_path):
    """The end of a pause goes on along the path that the pause interrupted, and no other."""
    text = """
trees:
  main:
    sequence:
      - run: Localise
      - optional: true
        do:
          timeout: 3 s
          do:
            run: ScanSwing
            with: {angle: 60 deg, duration: 8 s}
      - wait: 9 s
"""
    positions = []

    def watch(mission):
        pause(mission)
        if mission.clock.now_s() > 1:
            positions.append(mission.services.arm()[0])

    pause = PauseAt(10.0, ticks=20)
    result = run(tmp_path, text, after_tick=watch)
    assert result.report.outcome == "success"
    cut_off = [e for e in entries(result) if e.kind == "node_timed_out"]
    assert cut_off
    assert positions[-1] == positions[-60]


def test_a_plugin_that_fails_when_it_is_told_ends_the_mission_safely(tmp_path, monkeypatch):
    def paused(self, now_s):
        raise RuntimeError("no pause today")

    monkeypatch.setattr(
        "executive_plugins.mapping.voxel_map.VoxelMap.paused", paused, raising=False
    )
    result = run(tmp_path, SWING, after_tick=PauseAt(6.0, ticks=60))
    assert (result.report.outcome, result.exit_status) == ("fault", 3)
    assert "mapping plugin 'voxel_map' failed in 'paused'" in result.report.reason


@pytest.fixture
def slow_person(monkeypatch):
    """Somebody at the terminal who answers when told to."""
    answered = threading.Event()

    def read_line():
        answered.wait()
        return "yes\n"

    monkeypatch.setattr(
        "executive.mission.run.Operator", lambda preset, **_: Operator(preset, read_line)
    )
    return answered


def test_mission_time_stands_still_while_a_person_is_asked(tmp_path, slow_person):
    polls = []

    def answer_late(mission):
        if mission.phase is Phase.AWAITING_OPERATOR:
            polls.append(mission.clock.now_s())
            if len(polls) == 30:
                slow_person.set()

    ask = """
loop: {time_limit: 3 s}
trees:
  main:
    timeout: 2 s
    sequence:
      - wait: 0.5 s
      - ask: Is the site clear?
      - wait: 1 s
"""
    result = run(tmp_path, ask, after_tick=answer_late)
    assert result.report.outcome == "success", result.report.reason
    assert len(set(polls)) == 1
    assert result.report.pauses.count == 1
    at_once = run(tmp_path, ask, name="at_once", answer=True)
    assert [line[:4] for line in story(result)] == [line[:4] for line in story(at_once)]


def test_a_machine_that_moves_beside_a_question_is_held_while_it_is_open(tmp_path, slow_person):
    speeds = []

    def answer_late(mission):
        if mission.phase is Phase.AWAITING_OPERATOR:
            speeds.append(abs(mission.services.joints().velocity).max())
            if len(speeds) == 100:
                slow_person.set()

    text = """
trees:
  main:
    sequence:
      - run: Localise
      - parallel:
          - run: ScanSwing
            with: {angle: 60 deg, duration: 8 s}
          - sequence: [{wait: 4 s}, {ask: Go on?}]
"""
    result = run(tmp_path, text, after_tick=answer_late)
    assert result.report.outcome == "success", result.report.reason
    assert speeds[0] > 0.05
    assert speeds[99] < 0.01  # when the answer came; then it takes up its speed again


def test_a_mission_that_is_stopped_in_a_pause_ends_stopped(tmp_path):
    ticks = []

    def pause_then_stop(mission):
        if mission.clock.now_s() >= 6.0:
            ticks.append(1)
        if len(ticks) == 1:
            mission.toggle_pause()
        if len(ticks) == 40:
            mission.request_stop()

    result = run(tmp_path, SWING, after_tick=pause_then_stop)
    assert (result.report.outcome, result.exit_status) == ("stopped", 1)


def test_the_pretended_jaws_are_held_in_a_pause_as_well():
    machine = load_machine("m545")
    robot = KinematicRobot(KinematicRobot.Settings(), machine)
    robot.command(MoveJaws(0.0, 1e4))
    robot.read(0.5)
    robot.stop()
    robot.paused(0.5)
    jaws = [one.of(machine.jaw.name)[0] for one in robot.read(3.0) if isinstance(one, JointSample)]
    assert jaws[0] == jaws[-1] > 0.4
    robot.resume()
    robot.resumed(0.5)
    assert robot.read(6.0)[-1].of(machine.jaw.name)[0] == pytest.approx(0.4)


class AskedOnTheWay:
    """Drives the chassis, asks for something on the way, and notes its speed from then on."""

    def __init__(self, ask):
        self.ask, self.speeds = ask, []

    def __call__(self, mission):
        driver = mission._robot._driver
        if self.speeds:
            self.speeds.append(driver.speed_m_s)
        elif 2.0 < mission.clock.now_s() < 4.0:
            mission._robot.command(Drive(0.6, 0.0))
            if driver.speed_m_s > 0.3:
                self.speeds.append(driver.speed_m_s)
                self.ask(mission)
        if mission.pause.is_still:
            mission.toggle_pause()


DRIVES = """  driving: dubins
trees: {main: {sequence: [{run: Localise, timeout: 30 s}, {wait: 5 s}]}}
"""


def test_a_machine_that_drives_brakes_before_time_stands_still(tmp_path):
    way = AskedOnTheWay(lambda mission: mission.toggle_pause())
    result = run(tmp_path, DRIVES, after_tick=way)
    assert result.report.outcome == "success"
    assert result.report.pauses.count == 1
    pause_s = result.report.pauses.machine_s
    braked = way.speeds.index(0.0)
    assert braked * 0.05 <= pause_s, "it went on before it stood"
    assert not any(way.speeds[braked:])


def test_a_machine_that_drives_brakes_before_a_stopped_mission_ends(tmp_path):
    way = AskedOnTheWay(lambda mission: mission.request_stop())
    result = run(tmp_path, DRIVES, after_tick=way)
    assert result.report.outcome == "stopped"
    assert way.speeds[-1] == 0.0
