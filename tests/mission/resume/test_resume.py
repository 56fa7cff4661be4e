"""A run that was cut off goes on: its folder is copied at a point, as kill -9 would leave it."""

import json
import shutil
import sys

import pytest
import toy_site
from toy_plugins import ToyRobot

from executive import registry
from executive.errors import ConfigError, DataError
from executive.events.mission import Resumed, WorldObserved
from executive.events.node import LeafAnswered, LeafTakenUp
from executive.journal import read_journal
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.resume import resumed_run
from executive.mission.run import Run
from executive.tree.load import load_mission

WITHOUT_SOCKET = shutil.ignore_patterns("control.sock")  # which ends with the process
DRY = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
  objects: sqlite
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - set: {rounds: 0}
      - loop: {max: 2}
        do:
          sequence:
            - run: ScanSwing
              with: {angle: 40 deg, duration: 2 s}
              timeout: 9 s
            - wait: 1 s
            - set: {rounds: "{rounds} + 1"}
      - check: "{rounds} == 2"
"""


def cut_at(tmp_path, text, ticks):
    """Run a mission to its end; return copies of its folder at some ticks."""
    path = tmp_path / "dry.yaml"
    path.write_text(text)
    made = Run(load_mission(str(path)), Options(run_dir=tmp_path / "run"))
    copies = {tick: tmp_path / f"cut{tick}" for tick in ticks}

    def copy(mission):
        if mission._tick in copies:
            shutil.copytree(tmp_path / "run", copies[mission._tick], ignore=WITHOUT_SOCKET)

    assert made.execute(copy).report.outcome == "success"
    return list(copies.values())


@pytest.fixture(scope="module")
def cuts(tmp_path_factory):
    return cut_at(tmp_path_factory.mktemp("cuts"), DRY, (20, 60, 110, 160))


def events(folder, kind):
    return [e.event for e in read_journal(folder / "journal.jsonl") if isinstance(e.event, kind)]


def test_a_mission_goes_on_from_wherever_it_was_cut_off(cuts):
    for folder in cuts:
        result = resumed_run(folder).execute(lambda mission: None)
        assert result.report.outcome == "success", result.report.reason
        (resumed,) = events(folder, Resumed)
        (observed,) = events(folder, WorldObserved)
        assert (observed.status, observed.held) == ("GLOBAL", None)
        assert "robot" in resumed.restored
        assert result.report.counts.scans == 2  # none is lost, and none made twice


def test_a_run_is_cut_off_again_and_again(tmp_path):
    (folder,) = cut_at(tmp_path, DRY, (45,))  # in the tick in which the first swing begins
    for number in range(3):
        copy = tmp_path / f"again{number}"

        def cut(mission, folder=folder, copy=copy, number=number):
            if events(folder, WorldObserved)[number:] and not copy.exists():
                shutil.copytree(folder, copy, ignore=WITHOUT_SOCKET)

        assert resumed_run(folder).execute(cut).report.outcome == "success"
        folder = copy
    assert resumed_run(folder).execute(lambda mission: None).report.counts.scans == 2
    assert len(events(folder, Resumed)) == 4


def test_a_resumed_run_can_be_stopped_before_it_has_followed_its_past(cuts, tmp_path):
    """In the tick in which it was cut off Localise had answered; the tree still waits for it."""
    entries = read_journal(cuts[0].parent / "run" / "journal.jsonl")
    last = next(e.tick for e in entries if isinstance(e.event, LeafAnswered))
    (folder,) = cut_at(tmp_path, DRY, (last + 1,))
    result = resumed_run(folder).execute(Mission.request_stop)
    assert (result.report.outcome, result.report.reason) == ("stopped", "stopped by the operator")


def test_what_was_under_way_is_taken_up_by_its_leafs_policy(tmp_path):
    (folder,) = cut_at(tmp_path, DRY, (60,))
    resumed_run(folder).execute(lambda mission: None)
    assert events(folder, Resumed)[0].under_way == ("main/2:loop/0:sequence/0:ScanSwing",)
    assert [event.policy for event in events(folder, LeafTakenUp)] == ["redo"]


def test_a_run_that_has_ended_is_not_resumed(cuts, tmp_path):
    with pytest.raises(ConfigError, match=r"has ended \(success\)"):
        resumed_run(cuts[0].parent / "run")
    with pytest.raises(ConfigError, match="holds no run"):
        resumed_run(tmp_path)


def test_a_torn_last_line_is_healed_and_a_changed_one_refused(tmp_path):
    torn, changed, other = cut_at(tmp_path, DRY, (60, 61, 62))
    with (torn / "journal.jsonl").open("a") as file:
        file.write('{"sequence":99,"tick"')
    assert resumed_run(torn).execute(lambda mission: None).report.outcome == "success"
    assert events(torn, Resumed)[0].cut_off_bytes == 21
    journal = changed / "journal.jsonl"
    journal.write_text(journal.read_text().replace("Localise", "Localize"))
    with pytest.raises(DataError, match=r"journal\.jsonl:\d+: .*changed or lost"):
        resumed_run(changed)
    mission = other / "mission.yaml"
    mission.write_text(mission.read_text().replace("Localise", "OpenGripper"))
    with pytest.raises(DataError, match="cannot be followed at line"):
        resumed_run(other).execute(lambda mission: None)
    assert not events(other, Resumed)  # nothing was done


def test_a_run_in_use_is_refused(tmp_path):
    (tmp_path / "dry.yaml").write_text(DRY)
    first = Run(load_mission(str(tmp_path / "dry.yaml")), Options(run_dir=tmp_path / "run"))
    for attempt in (
        lambda: Run(load_mission(str(tmp_path / "dry.yaml")), Options(run_dir=tmp_path / "run")),
        lambda: resumed_run(tmp_path / "run"),
    ):
        with pytest.raises(ConfigError, match="another run writes into"):
            attempt()
    first.folder.release()


@pytest.fixture
def toy_mission(tmp_path, monkeypatch):
    """The mission of the toy's plugins, which no later test finds."""
    monkeypatch.setattr(sys, "path", [*sys.path])
    mission = toy_site.install(tmp_path / "toy")
    registry.reread()
    yield mission
    monkeypatch.undo()
    registry.reread()


def test_stones_are_where_they_belong_whenever_a_run_is_cut_off(tmp_path, monkeypatch, toy_mission):
    """Between the intention and the deed, in mid-carry, and between deed and journal; the command
    `python tests/benchmarks/kills.py` kills at random points.
    """
    made = Run(load_mission(str(toy_mission)), Options(run_dir=tmp_path / "run"))
    wanted = {("leaf_called", "CloseGripper"), ("stone_grasped", "CloseGripper")}
    wanted |= {("leaf_called", "ReleaseStone"), ("stone_released", "ReleaseStone")}
    copies = []

    def copy(entry):
        key = (entry.kind, entry.node.rpartition(":")[2])
        if key in wanted:
            wanted.remove(key)
            copies.append(tmp_path / f"cut-{'-'.join(key)}")
            shutil.copytree(tmp_path / "run", copies[-1], ignore=WITHOUT_SOCKET)

    made._journal.follow(copy)
    made.execute(lambda mission: None)
    assert not wanted
    for folder in copies:
        run, judged = resumed_run(folder), []
        close, plugins = run._close, run._assembly.plugins
        assert isinstance(plugins["robot"], ToyRobot)

        def judge(close=close, judged=judged, plugins=plugins):
            judged.append(judged or (plugins["robot"], plugins["objects"].stones()))
            close()

        monkeypatch.setattr(run, "_close", judge)
        report = run.execute(lambda mission: None).report
        assert toy_site.complaints(*judged[0], report) == [], folder.name
        assert json.loads((folder / "report.json").read_text()) == report.payload()


def test_a_resumed_run_can_be_watched_as_a_first_one_can(tmp_path, monkeypatch):
    import executive.mission.resume as resume

    asked = []
    monkeypatch.setattr(resume, "Run", lambda _, options, past: asked.append((options, past)))
    (folder,) = cut_at(tmp_path, DRY, (20,))
    resumed_run(folder, groot=1700, live=9900)
    ((options, past),) = asked
    past.folder.release()
    assert (options.groot, options.live, options.run_dir) == (1700, 9900, folder)
