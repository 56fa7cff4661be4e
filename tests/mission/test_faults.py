"""An error of a plugin or a leaf ends the mission in a safe stop, and says where it was raised."""

import json
import sys
from pathlib import Path

import pytest

from executive.commands.main import main
from executive.events.mission import Faulted, PluginFailed
from executive.journal import read_journal

PLUGINS = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  segmentation: ground_and_clusters
  motion: hermite
  objects: sqlite
"""
LOCALISE = "      - run: Localise\n        timeout: 30 s\n"
SCAN = """
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 30 deg, duration: 2 s}
"""
FINDS = "executive_plugins.segmentation.ground_and_clusters.GroundAndClusters"
MOVES = "executive_plugins.motion.hermite.Hermite"
MAPS = "executive_plugins.mapping.voxel_map.VoxelMap"


def raising(error, name="verb"):
    """Return a verb with a bug."""

    def verb(self, *args, **kwargs):
        raise error  # the author's line

    verb.__name__ = name
    return verb


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    def run_text(trees, *words, plugins=PLUGINS):
        (tmp_path / "dry.yaml").write_text(plugins + trees, encoding="utf-8")
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["executive", "run", "dry.yaml", "--run-dir=run", *words])
        with pytest.raises(SystemExit) as end:
            main()
        report = json.loads((tmp_path / "run" / "report.json").read_text(encoding="utf-8"))
        return int(end.value.code or 0), capsys.readouterr().err, report

    return run_text


def line_of(word):
    text = Path(__file__).read_text(encoding="utf-8").splitlines()
    return next(i for i, line in enumerate(text, 1) if word in line and "text" not in line)


AROUND = {
    "plain": "      - run: Segment\n",
    "retry": "      - run: Segment\n        retry: 5\n",
    "optional": "      - run: Segment\n        optional: true\n",
    "fallback": "      - fallback:\n          - run: Segment\n          - wait: 5 s\n",
    "on_failure": "      - run: Segment\n        on_failure: {wait: 5 s}\n",
}


@pytest.mark.parametrize("around", AROUND.values(), ids=list(AROUND))
def test_a_bug_in_a_plugin_ends_the_mission_whatever_is_around_the_leaf(
    run, monkeypatch, tmp_path, around
):
    monkeypatch.setattr(f"{FINDS}.merge", raising(ValueError("a bug"), "merge"))
    status, said, report = run(SCAN + around)
    place = f"test_faults.py:{line_of('# the author')}"
    assert status == 3
    assert report["outcome"] == "fault"
    for words in (
        "segmentation plugin 'ground_and_clusters' failed in 'verb': ValueError: a bug",
        place,
    ):
        assert words in said
        assert words in report["reason"]
    assert report["fault"]["place"].endswith(place)
    assert report["fault"]["node"].endswith("Segment")
    assert "Traceback" in report["fault"]["traceback"]
    assert "raise error" in (tmp_path / "run" / "log.txt").read_text(encoding="utf-8")
    faults = [
        entry.event
        for entry in read_journal(tmp_path / "run" / "journal.jsonl")
        if isinstance(entry.event, Faulted)
    ]
    assert [fault.fault.place for fault in faults] == [report["fault"]["place"]]


@pytest.mark.parametrize("runner", ["inline", "thread", "process"])
def test_a_bug_in_a_job_names_the_line_in_whatever_process_it_ran(run, runner):
    """A cloud of one point breaks no plugin, so the bug is one that its settings bring about."""
    status, said, report = run(SCAN + AROUND["optional"], f"--runner={runner}", plugins=BROKEN)
    assert status == 3, said
    assert "segmentation plugin 'broken' failed in 'segment': KeyError: 'nowhere'" in said
    assert "broken_segmentation.py:" in report["fault"]["place"]
    assert "table['nowhere']" in report["fault"]["traceback"].replace('"', "'")


BROKEN = PLUGINS.replace("ground_and_clusters", "broken")
PACKAGE = '''
import numpy as np

from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters


class Broken(GroundAndClusters):
    """A segmenter with a bug."""

    def merge(self, clouds):
        return clouds[0].__class__("map", np.zeros((1, 3)))

    def segment(self, cloud):
        if len(cloud) > 1:  # the cloud of the start, which compiles the inner loops
            return super().segment(cloud)
        table = {}
        return table["nowhere"]
'''


@pytest.fixture(autouse=True)
def package(tmp_path, monkeypatch):
    """Put a package with a broken plugin on the path, also for worker processes."""
    from executive import registry

    folder = tmp_path / "package"
    (folder / "broken.egg-info").mkdir(parents=True)
    (folder / "broken_segmentation.py").write_text(PACKAGE, encoding="utf-8")
    (folder / "broken.egg-info" / "PKG-INFO").write_text("Name: broken\nVersion: 1\n")
    (folder / "broken.egg-info" / "entry_points.txt").write_text(
        "[executive.segmentation.v1]\nbroken = broken_segmentation:Broken\n"
    )
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder), prepend=":")
    registry.reread()
    yield
    registry.reread()


def test_a_bug_in_motion_under_optional_is_no_success(run, monkeypatch):
    monkeypatch.setattr(f"{MOVES}.swing", raising(KeyError("J_BOOM"), "swing"))
    trees = SCAN.replace("- run: ScanSwing", "- optional: true\n        run: ScanSwing")
    status, said, report = run(trees)
    assert (status, report["outcome"]) == (3, "fault")
    assert "motion plugin 'hermite' failed" in said
    assert "KeyError: 'J_BOOM'" in said


def test_a_bug_in_a_leaf_names_the_leaf_and_the_line(run, monkeypatch):
    from executive.behaviours.localise import Localise

    def broken(self):
        yield None
        raise RuntimeError("not thought of")

    monkeypatch.setattr(Localise, "run", broken)
    status, said, report = run(SCAN)
    assert status == 3
    assert "behaviour 'Localise' failed: RuntimeError: not thought of" in said
    assert report["fault"]["node"] == "main/0:Localise"


def test_a_bug_in_a_stream_plugin_stops_the_machine(run, monkeypatch):
    target = "executive_plugins.estimation.filters.gnss_imu_filter.GnssImuFilter"
    monkeypatch.setattr(f"{target}.add_gnss", raising(IndexError("no such fix")))
    status, said, _ = run(SCAN)
    assert status == 3
    assert "estimation plugin 'gnss_imu_filter' failed in 'verb': IndexError" in said


@pytest.mark.parametrize("verb", ["start", "cloud", "close"])
def test_a_bug_before_or_after_the_loop_is_a_fault_with_a_whole_report(run, monkeypatch, verb):
    """The map is saved after the loop; a plugin that cannot be saved or closed loses nothing."""
    monkeypatch.setattr(f"{MAPS}.{verb}", raising(IndexError("no such voxel")))
    status, said, report = run("trees: {main: {wait: 0.2 s}}\n")
    assert (status, report["outcome"]) == (3, "fault")
    assert "mapping plugin 'voxel_map' failed in 'verb': IndexError: no such voxel" in said


def test_a_bug_in_a_constructor_is_told_with_its_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(f"{MAPS}.__init__", lambda self, settings, machine: 1 / 0)
    (tmp_path / "dry.yaml").write_text(PLUGINS + "trees: {main: {wait: 0.2 s}}", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["executive", "run", "dry.yaml", "--run-dir", "run"])
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr().err
    assert end.value.code == 3
    assert "ZeroDivisionError" in said
    assert "while the mapping plugin 'voxel_map' was made" in said
    assert "test_faults.py:" in said


def test_a_plugin_that_the_mission_can_do_without_fails_its_node(run, monkeypatch, tmp_path):
    monkeypatch.setattr(f"{FINDS}.merge", raising(ValueError("a bug"), "merge"))
    plugins = PLUGINS.replace(
        "segmentation: ground_and_clusters",
        "segmentation: {plugin: ground_and_clusters, on_error: fail}",
    )
    status, _, report = run(SCAN + AROUND["optional"], plugins=plugins)
    assert (status, report["outcome"]) == (0, "success")
    assert report["counts"]["plugin_failures"] == 1
    assert "Traceback" in (tmp_path / "run" / "log.txt").read_text(encoding="utf-8")
    failed = [
        entry
        for entry in read_journal(tmp_path / "run" / "journal.jsonl")
        if isinstance(entry.event, PluginFailed)
    ]
    assert len(failed) == 1


def test_without_that_word_no_mission_does_without_a_plugin(tmp_path, monkeypatch, capsys):
    wrong = PLUGINS.replace(
        "estimation: gnss_imu_filter", "estimation: {plugin: gnss_imu_filter, on_error: fail}"
    )
    wrong = wrong.replace("motion: hermite", "motion: {plugin: hermite, on_error: ignore}")
    (tmp_path / "dry.yaml").write_text(wrong + SCAN, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["executive", "check", "dry.yaml"])
    with pytest.raises(SystemExit) as end:
        main()
    said = capsys.readouterr().err
    assert end.value.code == 2
    assert "no mission can do without its estimation plugin" in said
    assert "'on_error' is stop or fail, not ignore" in said


def test_the_machine_is_at_rest_after_a_fault(run, monkeypatch):
    """The leaf commands a swing and then breaks: the robot must have been told to stop."""
    from executive_plugins.robot.kinematic import KinematicRobot

    from executive.leaf import swing

    stops = []
    safe_stop = KinematicRobot.safe_stop

    def noted(self, reason):
        stops.append(self)
        safe_stop(self, reason)

    def broken(context, trajectory):
        from executive.interfaces.robot import Robot
        from executive.messages.command import Follow

        context.use(Robot).command(Follow(trajectory))
        yield None
        raise RuntimeError("in mid-swing")

    monkeypatch.setattr(KinematicRobot, "safe_stop", noted)
    monkeypatch.setattr(swing, "follow", broken)
    status, _, _ = run(SCAN)
    assert status == 3
    assert "in mid-swing" in stops[0].latched()
    assert abs(stops[0]._dq).max() < 0.01  # what counts as rest


def test_of_several_errors_of_closing_the_first_is_reported_and_all_are_logged(
    run, monkeypatch, tmp_path
):
    closed = []
    monkeypatch.setattr(f"{MAPS}.close", raising(IndexError("no such voxel"), "close"))
    monkeypatch.setattr(f"{MOVES}.close", raising(KeyError("no such joint"), "close"))
    monkeypatch.setattr(f"{FINDS}.close", lambda self: closed.append("segmentation"))
    status, said, _ = run("trees: {main: {wait: 0.2 s}}\n")
    log = (tmp_path / "run" / "log.txt").read_text(encoding="utf-8")
    assert status == 3
    assert "motion plugin 'hermite' failed" in said
    assert "no such voxel" in log
    assert "no such joint" in log
    assert closed == ["segmentation"]
