"""The tick loop of short missions of a machine that stands: what its journal tells, and when."""

import shutil
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from executive_plugins.robot.kinematic import KinematicRobot
from executive_plugins.viewing.none import NoViewer

from executive.clock import SimulatedClock
from executive.errors import ConfigError, RobotError
from executive.events.mission import (
    Faulted,
    PauseEnded,
    PhaseChanged,
    Resumed,
    StopFailed,
    TickLate,
)
from executive.events.site import RegionNamed
from executive.events.watch import MissionHeld, MissionWentOn
from executive.journal import read_journal
from executive.mission.guard import Guard
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.resume import resumed_run
from executive.mission.run import Result, Run
from executive.mission.stop_signals import Aborted
from executive.supervision.beacon import beacon
from executive.tree.load import load_mission
from executive.watch.watch import Decision, Wish

TICK_S = 0.05
HEAD = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  viewing: none
"""
WAIT = HEAD + "trees: {main: {wait: 1 s}}\n"


def run(folder: Path, each: Any = lambda mission: None, text: str = WAIT, **options: Any) -> Result:
    """Run a mission; `each` is called after each tick."""
    (folder / "dry.yaml").write_text(text)
    made = Run(load_mission(str(folder / "dry.yaml")), Options(run_dir=folder / "run", **options))
    return made.execute(each)


def told(result: Result, *kinds: type) -> list[Any]:
    entries = read_journal(result.folder.journal)
    return [entry.event for entry in entries if not kinds or isinstance(entry.event, kinds)]


def phases(result: Result) -> list[tuple[str, str, str]]:
    return [(one.before, one.after, one.reason) for one in told(result, PhaseChanged)]


@dataclass
class Once:
    """Calls something after the first tick that ends at a time or later."""

    at_s: float
    do: Any
    is_done: bool = False

    def __call__(self, mission: Mission) -> None:
        if not self.is_done and mission.clock.machine_s() >= self.at_s - 1e-9:
            self.is_done = True
            self.do(mission)


def test_a_mission_that_is_stopped_waits_until_its_machine_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stops: list[str] = []
    monkeypatch.setattr(KinematicRobot, "stop", lambda robot: stops.append("stop"))
    stood = iter([False, False, False, True])
    monkeypatch.setattr(
        "executive.mission.mission.Standstill.reached", lambda self, joints: next(stood)
    )
    result = run(tmp_path, Once(0.5, Mission.request_stop))
    why = "stopped by the operator"
    assert (result.report.outcome, result.report.reason) == ("stopped", why)
    assert result.exit_status == 1
    assert phases(result) == [
        ("idle", "running", ""),
        ("running", "stopping", why),
        ("stopping", "done", why),
    ]
    assert stops
    last = list(read_journal(result.folder.journal))[-1]
    assert last.time_s == pytest.approx(0.5 + 4 * TICK_S)  # a tick to notice it, three to stand


def test_mission_time_stands_still_in_a_pause_while_the_machine_comes_to_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    idle: list[float] = []
    monkeypatch.setattr(SimulatedClock, "idle", lambda clock: idle.append(clock.now_s()))
    seen: list[float] = []

    def go_on_after_three(mission: Mission) -> None:
        seen.append(mission.clock.now_s())
        if len(idle) == 3:
            idle.append(-1.0)
            mission.toggle_pause()

    def each(mission: Mission) -> None:
        pause(mission)
        go_on_after_three(mission)

    pause = Once(0.5, Mission.toggle_pause)
    result = run(tmp_path, each)
    assert result.report.outcome == "success"
    assert [one[1:] for one in phases(result)] == [
        ("running", ""),
        ("paused", "paused by the operator"),
        ("running", "resumed by the operator"),
        ("stopping", ""),
        ("done", ""),
    ]
    (ended,) = told(result, PauseEnded)
    alone = run(tmp_path_of(tmp_path, "alone"))
    last, first = (list(read_journal(one.folder.journal))[-1] for one in (result, alone))
    assert (last.tick, last.time_s) == (first.tick, first.time_s)  # no tick of the mission is lost
    assert idle[:3] == pytest.approx([0.5] * 3)
    stood = seen.count(pytest.approx(0.5))
    assert ended.machine_s == pytest.approx((stood - 4) * TICK_S)  # but for 3 idle and the first
    assert result.report.pauses.count == 1
    assert result.report.pauses.machine_s == pytest.approx(ended.machine_s)


def tmp_path_of(folder: Path, name: str) -> Path:
    made = folder / name
    made.mkdir()
    return made


def test_a_broken_condition_holds_the_mission_until_it_holds_again(tmp_path: Path) -> None:
    wishes = [
        *2 * [Decision(Wish.HOLD, "gnss", "no fix for 2 s")],
        Decision(Wish.GO_ON, reason="gnss is well again"),
    ]

    def watch(mission: Mission) -> None:
        held.append((mission.is_held, mission.phase.value, mission.phase_reason))
        if mission.clock.machine_s() >= 0.5 - 1e-9:
            mission.guard.step = lambda read_s: wishes.pop(0) if wishes else Decision(Wish.GO_ON)

    held: list[tuple[bool, str, str]] = []
    result = run(tmp_path, watch)
    assert result.report.outcome == "success"
    (began,), (ended,) = told(result, MissionHeld), told(result, MissionWentOn)
    assert (began.condition, began.reason) == ("gnss", "no fix for 2 s")
    assert (ended.reason, ended.held_s) == ("gnss is well again", pytest.approx(2 * TICK_S))
    assert ended.moved_m < 0.1
    assert [one[1:] for one in phases(result)][1:3] == [
        ("held", "no fix for 2 s"),
        ("running", ""),
    ]
    assert [one for one in held if one[0]] == 2 * [(True, "held", "no fix for 2 s")]


def test_a_condition_that_asks_for_a_stop_is_a_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    latched: list[str] = []
    monkeypatch.setattr(KinematicRobot, "safe_stop", lambda robot, why: latched.append(why))

    def ask(mission: Mission) -> None:
        mission.guard.step = lambda read_s: Decision(Wish.STOP, "geofence", "0.2 m outside")

    result = run(tmp_path, Once(0.5, ask))
    assert (result.report.outcome, result.exit_status) == ("fault", 3)
    (faulted,) = told(result, Faulted)
    assert faulted.fault.component == "watched condition 'geofence'"
    assert faulted.fault.error == "0.2 m outside"
    assert latched == [faulted.fault.summary] == [result.report.reason]
    assert [one[1] for one in phases(result)] == ["running", "faulted"]


def test_a_stop_that_fails_is_told_beside_the_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuses(robot: KinematicRobot, reason: str) -> None:
        raise RobotError("the valves do not answer")

    def fails(mission: Mission) -> None:
        raise ValueError("a step of the loop is wrong")

    monkeypatch.setattr(KinematicRobot, "safe_stop", refuses)
    monkeypatch.setattr(
        "executive.mission.mission.Standstill.await_alone",
        lambda *given: (_ for _ in ()).throw(RobotError("no sample comes")),
    )
    result = run(
        tmp_path, Once(0.5, lambda mission: mission.between.append(lambda: fails(mission)))
    )
    assert (result.report.outcome, result.exit_status) == ("fault", 3)
    assert "a step of the loop is wrong" in result.report.reason
    said = [one.reason for one in told(result, StopFailed)]
    assert "RobotError: the valves do not answer" in said
    assert said[-1] == "RobotError: no sample comes"
    assert "the robot's safe stop failed" in result.folder.log.read_text()


def test_an_error_while_the_machine_comes_to_rest_is_a_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(self: object, joints: object) -> bool:
        raise RobotError("no sample comes")

    monkeypatch.setattr("executive.mission.mission.Standstill.reached", fails)
    result = run(tmp_path)
    assert (result.report.outcome, result.exit_status) == ("fault", 3)
    assert "no sample comes" in result.report.reason
    assert [one[1] for one in phases(result)] == ["running", "stopping", "faulted"]


def test_a_run_that_is_ended_at_once_stops_the_machine_and_writes_its_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    latched: list[str] = []
    monkeypatch.setattr(KinematicRobot, "safe_stop", lambda robot, why: latched.append(why))

    def ends(mission: Mission) -> None:
        raise Aborted("stopped at once by the operator")

    result = run(tmp_path, Once(0.5, ends))
    assert result.report.payload()["reason"] == "stopped at once by the operator"
    assert (result.report.outcome, result.exit_status) == ("stopped", 1)
    assert latched == ["the run was ended at once"]
    assert [entry.kind for entry in read_journal(result.folder.journal)][-1] == "mission_ended"


def test_a_folder_that_cannot_be_written_ends_the_mission(tmp_path: Path) -> None:
    def full(mission: Mission) -> None:
        mission._setup.keeper.failure = OSError(28, "No space left on device")

    result = run(tmp_path, Once(0.5, full))
    assert (result.report.outcome, result.exit_status) == ("fault", 3)
    assert "No space left on device: the run's folder cannot be written" in result.report.reason
    assert len(told(result, Faulted)) == 1


def test_late_ticks_and_what_workers_tell_are_in_the_journal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    advance, late = SimulatedClock.advance, iter([0.0, 0.02])
    monkeypatch.setattr(
        SimulatedClock, "advance", lambda clock, dt_s: advance(clock, dt_s) or next(late, 0.0)
    )
    tell = StopFailed("a worker says so")
    result = run(tmp_path, Once(0.5, lambda mission: mission._setup.jobs.told.append(tell)))
    (tick_late,) = told(result, TickLate)
    assert (tick_late.late_s, tick_late.in_a_row) == (0.02, 1)
    (said,) = [e for e in read_journal(result.folder.journal) if e.kind == "stop_failed"]
    assert said.event.reason == tell.reason
    assert said.time_s == pytest.approx(0.5)
    assert result.report.late_ticks.count == 1


def test_what_is_shown_and_named_while_a_mission_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: dict[str, list[float]] = {}
    monkeypatch.setattr(
        NoViewer, "show", lambda self, at_s, name, value: shown.setdefault(name, []).append(at_s)
    )
    opened: list[str] = []
    monkeypatch.setattr(NoViewer, "open", lambda self, path: opened.append(path), raising=False)
    text = WAIT + "regions: {yard: {polygon: [[0 m, 0 m], [4 m, 0 m], [4 m, 3 m]]}}\n"
    result = run(tmp_path, text=text, record=True)
    (named,) = told(result, RegionNamed)
    assert (named.name, named.corners_map.tolist()) == ("yard", [[0, 0], [4, 0], [4, 3]])
    assert opened == [str(result.folder.recording)]
    assert result.folder.recording.name == "recording.rrd"
    assert shown["regions/yard"] == [0.0]
    assert shown["tree"] == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    assert shown["state"] == shown["tree"]
    assert shown["joints"] == shown["tree"][1:]  # there was no sample yet


@pytest.mark.parametrize("name", ["main", "wait"])
def test_a_fault_may_wait_for_the_root_to_begin(tmp_path: Path, name: str) -> None:
    fault = f"faults: [{{sensor: imu, how: silent, node: {name}, after: 0.4 s}}]\n"
    result = run(tmp_path, text=WAIT + fault)
    began = [one for one in read_journal(result.folder.journal) if one.kind == "fault_injected"]
    assert [one.time_s for one in began] == pytest.approx([0.4])


def test_a_run_that_was_cut_off_goes_on_at_its_tick(tmp_path: Path) -> None:
    cut = tmp_path / "cut"

    def copy(mission: Mission) -> None:
        without = shutil.ignore_patterns("control.sock")
        shutil.copytree(tmp_path / "run", cut, ignore=without)

    whole = run(tmp_path, Once(0.2, copy), text=WAIT.replace("1 s", "0.4 s"))
    ticks: list[int] = []
    result = resumed_run(cut).execute(lambda mission: ticks.append(mission.tick))
    assert result.report.outcome == "success", result.report.reason
    (resumed,) = told(result, Resumed)
    assert "robot" in resumed.restored
    entries = list(read_journal(result.folder.journal))
    (at,) = [one for one in entries if isinstance(one.event, Resumed)]
    assert (at.tick, at.time_s) == (4, pytest.approx(0.2))
    assert ticks[0] == 5
    waited = [one for one in entries if one.kind == "node_ended"][-1]
    before = [one for one in read_journal(whole.folder.journal) if one.kind == "node_ended"][-1]
    assert waited.time_s >= before.time_s


def test_time_begins_anew_when_a_mission_begins_and_joints_are_told_to_the_supervisor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    monkeypatch.setattr(SimulatedClock, "start", lambda clock: told.append("start"))
    monkeypatch.setattr(beacon(), "see_joints", lambda: told.append("joints"), raising=False)
    run(tmp_path, Once(0.5, lambda mission: told.append("half")))
    assert told[:2] == ["start", "start"]  # with the tree, and with the loop
    assert told[2:].count("start") == 0
    half = told.index("half")
    assert told[2:half] == 9 * ["joints"]  # from the second tick on there are samples


def test_what_a_failed_start_leaves_open_is_closed_and_its_error_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed: list[str] = []

    def fails(robot: KinematicRobot) -> None:
        raise ConfigError("the site has no room")

    def close(robot: KinematicRobot) -> None:
        closed.append("robot")
        raise RuntimeError("it hangs")

    monkeypatch.setattr(KinematicRobot, "start", fails)
    monkeypatch.setattr(KinematicRobot, "close", close)
    with pytest.raises(ConfigError, match="the site has no room"):
        run(tmp_path)
    assert closed == ["robot"]
    assert "a plugin failed while it was closed" in (tmp_path / "run" / "log.txt").read_text()


def test_times_of_a_report_have_three_decimals(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wall = iter([10.0, 10.0 + 3.000123, *[20.0] * 10_000])
    monkeypatch.setattr("executive.mission.run.wall_s", lambda: next(wall))
    report = run(tmp_path).report
    assert report.ended_s == pytest.approx(1.05)
    assert (report.wall_s, report.real_time_factor) == (3.0, 0.35)
    wall = iter([10.0, 13.7, *[20.0] * 10_000])
    assert run(tmp_path_of(tmp_path, "again")).report.real_time_factor == 0.284


def test_the_report_judges_a_state_a_second_and_none_in_a_pause(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    judged: list[float] = []
    monkeypatch.setattr(Guard, "judge", lambda guard, state: judged.append(state.stamp_s))
    text = WAIT.replace("1 s", "4 s")
    run(tmp_path, text=text)
    assert len(judged) >= 3
    assert [round(b - a, 1) for a, b in pairwise(judged)] == [1.0] * (len(judged) - 1)
    without, alone = len(judged), tmp_path_of(tmp_path, "paused")
    judged.clear()

    def each(mission: Mission) -> None:
        hold(mission)
        if mission.pause.is_on:
            paused.append(len(judged))
            if len(paused) == 30:
                mission.toggle_pause()

    hold, paused = Once(1.5, Mission.toggle_pause), []
    run(alone, each, text=text)
    assert len({*paused}) == 1
    assert len(judged) == without
