"""What verbs tell of missions, clouds and contracts, each without a mission, a robot or a pool."""

import json
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from executive import registry
from executive.campaign.description import schema as campaigns
from executive.commands.campaigns import pool
from executive.commands.campaigns.progress import SilentProgress
from executive.commands.clouds import segment
from executive.commands.clouds.convert import _crs_of
from executive.commands.clouds.crop import Crop
from executive.commands.missions import ctl
from executive.errors import ConfigError, DataError
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.mission.judging import _judge
from executive.tree import load
from executive.tree.problem import Mark, MissionFileError, Problem
from executive.tree.words import vocabulary
from tests.commands.in_process import executive

POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [3.0, 0.5, 0.0]])


@pytest.mark.parametrize(
    ("words", "kept"),
    [
        (None, [0, 1, 2]),
        ("0,0,1.5", [0, 1]),
        ("0,0,1.4", [0]),
        ("3,0.5,0.01", [2]),
        ("0,0,1,1", [0, 1]),
        ("0.5,0.4,3,0.5", [2]),
        ("-1,-1,0,0", [0]),
    ],
)
def test_a_crop_is_a_circle_or_a_rectangle_with_its_edges(words, kept):
    assert np.flatnonzero(Crop(words).inside(POINTS)).tolist() == kept
    assert Crop(words).of(Cloud("map", POINTS)).points.tolist() == POINTS[kept].tolist()


@pytest.mark.parametrize(
    "words", ["", "1", "1,2", "1,2,0", "1,2,-3", "1,2,1,3", "1,2,3,2", "1,2,3,4,5", "a,b,c"]
)
def test_an_area_that_is_none_is_refused(words):
    with pytest.raises(ConfigError, match=f"--crop: '{words}' is not x,y,radius or x_low"):
        Crop(words)


def test_an_area_without_a_point_is_told_with_what_the_cloud_spans():
    with pytest.raises(DataError, match=r"no point is in 9,9,1; the cloud has x from 0 to 3 m and"):
        Crop("9,9,1").inside(POINTS)


def status(**fields):
    known = {"phase": "running", "reason": "", "mission_s": 12.345, "running": [], "failed": [],
             "questions": [], "latched": ""}  # fmt: skip
    return known | fields


def test_how_a_mission_is_is_told_line_by_line():
    assert ctl._lines(status()) == ["running", "  mission time  12.35 s"]
    told = ctl._lines(
        status(
            reason="slow",
            running=[{"node": "main/0", "says": "3 m left"}, {"node": "main/1", "says": ""}],
            failed=[{"node": "main/2", "reason": "stuck"}],
            questions=[{"text": "Go?", "answers": ["yes", "no"], "node": "main/3"}],
            latched="a stop",
        )
    )
    assert told[0] == "running: slow"
    assert told[2:] == [
        "  runs          main/0  3 m left",
        "  runs          main/1",
        "  failed        main/2: stuck (skip, retry or resume)",
        "  asks          Go? [yes, no]  main/3",
        "  latched       a stop (reset)",
    ]


def test_a_mission_without_mistakes_is_told_with_its_warnings(monkeypatch, capsys):
    found = SimpleNamespace(name="yard", warnings=["a.yaml:3: warning: odd"])
    asked = []
    monkeypatch.setattr(load, "load_mission", lambda *given, **more: asked.append(given) or found)
    assert executive(monkeypatch, "check", "yard.yaml", "--set", "a.b=1") == 0
    assert capsys.readouterr().err == "a.yaml:3: warning: odd\nyard: no mistake found\n"
    assert [(name, list(settings)) for name, settings in asked] == [("yard.yaml", ["a.b=1"])]
    assert executive(monkeypatch, "check", "yard.yaml", "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer == {"mission": "yard", "problems": [], "warnings": ["a.yaml:3: warning: odd"]}


def test_mistakes_are_told_to_programs_too(monkeypatch, capsys):
    def refuse(*given, **more):
        raise MissionFileError([Problem(Mark("a.yaml", 3, 1), "odd")])

    monkeypatch.setattr(load, "load_mission", refuse)
    assert executive(monkeypatch, "check", "yard.yaml", "--json") == 2
    said = capsys.readouterr()
    problems = ["a.yaml:3:1: error: odd"]
    assert json.loads(said.out) == {"mission": None, "problems": problems, "warnings": []}
    assert said.err == "a.yaml:3:1: error: odd\n"


def test_the_schema_of_campaigns_is_printed(monkeypatch, capsys):
    monkeypatch.setattr(campaigns, "campaign_schema", lambda: {"title": "campaign"})
    monkeypatch.setattr("executive.tree.schema.mission_schema", lambda: {"title": "mission"})
    assert executive(monkeypatch, "schema", "--campaign") == 0
    assert json.loads(capsys.readouterr().out) == {"title": "campaign"}
    assert executive(monkeypatch, "schema") == 0
    assert json.loads(capsys.readouterr().out) == {"title": "mission"}


def test_a_whole_mission_is_shown_to_programs(monkeypatch, capsys):
    assert executive(monkeypatch, "show", "map_site", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["api"], found["mission"]) == (1, "map_site")
    assert "main" in found["trees"]
    assert executive(monkeypatch, "show", "map_site", "--as", "txt") == 2
    assert "Did you mean 'text'" in capsys.readouterr().err


def test_a_leaf_that_cannot_be_loaded_is_named_and_the_others_are_listed(monkeypatch, capsys):
    known = SimpleNamespace(broken={"Odd": "no module 'x'"}, words={})
    monkeypatch.setattr(vocabulary, "vocabulary", lambda: known)
    assert executive(monkeypatch, "words") == 0
    said = capsys.readouterr()
    assert said.err == "warning: the leaf 'Odd' is left out: no module 'x'\n"
    assert said.out.startswith("Nodes:\n")
    assert executive(monkeypatch, "words", "--json") == 0
    assert json.loads(capsys.readouterr().out) == []


class Segmenter:
    def __init__(self, segments, **fields):
        known = {"left_out": (), "scattered_points": 0, "warnings": ()}
        self.found = SimpleNamespace(segments=segments, **(known | fields))

    def segment(self, cloud):
        return self.found


def test_what_is_left_out_of_segments_is_told(monkeypatch, tmp_path):
    told, shown = [], []
    monkeypatch.setattr(segment, "say", told.append)
    monkeypatch.setattr(segment, "_answer", lambda found: {"segments": len(found.segments)})
    monkeypatch.setattr(segment, "show", lambda path, entities: shown.append(entities))
    monkeypatch.setattr(segment, "recording_of", lambda path, out: path)
    monkeypatch.setattr(segment, "shifted", lambda found, offset: offset)
    place = SimpleNamespace(crs="EPSG:2056")
    site = SimpleNamespace(points=POINTS + 9e4, place=place)
    monkeypatch.setattr("executive.clouds.reader.read_cloud", lambda path: site)
    rest = SimpleNamespace(kind="wall", points=7, centroid=np.array([1.0, 2.0, 3.0]), reason="flat")
    one = Segment(4, POINTS, POINTS.mean(axis=0), np.ptp(POINTS, axis=0))
    plugin = Segmenter((one,), left_out=(rest,), scattered_points=12, warnings=("sparse",))
    path = tmp_path / "site.ply"
    find = partial(segment._found, plugin, Crop(None), None, None)
    answer = segment._segmented(find, path, None, True)
    assert answer == {"segments": 1, "crs": "EPSG:2056"}
    assert told == [
        "    4        3 points at 1.33 0.50 0.00 m, 3.00 1.00 0.00 m long",
        "  left out: wall, 7 points at 1.00 2.00 3.00 m, flat",
        "  left out: 12 points above the ground in tiny clusters",
        "warning: sparse",
        f"{path}: 1 segments of 3 points",
    ]
    (entities,) = shown
    assert np.abs(entities["cloud"].points).max() < 1e3  # near its own origin
    np.testing.assert_allclose(entities["cloud"].points + entities["segments"], site.points)
    told.clear()
    segment._segmented(partial(segment._found, Segmenter(()), Crop(None), None, None), path, None)
    assert told == [f"{path}: 0 segments of 3 points"]


@pytest.mark.parametrize(
    ("text", "crs"),
    [('{"crs": "EPSG:2056"}', "EPSG:2056"), ('{"crs": 3}', ""), ("[1]", ""), ("1 0\n0 1", ""),
     ("{}", ""), ("[" * 100000, "")],
)  # fmt: skip
def test_the_coordinate_system_of_an_answer_goes_with_its_pose(tmp_path, text, crs):
    path = tmp_path / "pose.json"
    path.write_text(text)
    assert _crs_of(str(path)) == crs
    assert _crs_of("1,2,3") == ""


def test_runs_go_to_this_computer_or_to_a_scheduler_and_not_to_both(monkeypatch):
    with pytest.raises(ConfigError, match="--jobs: the workers of the scheduler say how many"):
        pool.pool_of(3, "tcp://127.0.0.1:1")
    made = []
    monkeypatch.setattr(
        "executive.campaign.execution.local_pool.LocalPool", lambda jobs: made.append(jobs) or "own"
    )
    assert pool.pool_of(3, None) == "own"
    monkeypatch.setattr(pool.os, "sched_getaffinity", lambda pid: {0, 1, 4, 5, 6})
    pool.pool_of(None, None)
    assert made == [3, 5]


def test_without_progress_nothing_is_told(capsys):
    with SilentProgress() as progress:
        progress(None)
    assert capsys.readouterr() == ("", "")


def test_a_judge_is_given_what_was_built_alone(monkeypatch):
    judge = SimpleNamespace(judge=lambda built: {"of": built})
    loaded = []
    monkeypatch.setattr(registry, "load", lambda *given: loaded.append(given) or (lambda: judge))
    assert _judge("strict", "a wall") == {"of": "a wall"}
    assert loaded == [("judge", "strict")]
