"""Leaves that save and load maps, ticked in a tree to success and to failure."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from executive.behaviours.load_map import LoadMap
from executive.behaviours.save_map import SaveMap
from executive.clouds.ply_writer import write_ply
from executive.events.finding import MapLoaded, MapSaved
from executive.geometry.geodesy import geodetic_from_enu
from executive.leaf.map_file import read_map

POINTS = np.random.default_rng(0).uniform(-2, 2, (40, 3))


HERE = (47.4084, 8.5106, 440.0)


@pytest.fixture
def site(stage, tmp_path):
    stand = stage.Stage(mapping=stage.PointMap(POINTS), estimation=SimpleNamespace(map_origin=None))
    stand.leaf_context.run_folder = tmp_path
    return stand


def test_a_map_is_saved_with_its_frame_and_the_pose(site, tmp_path) -> None:
    ended = site.tick(SaveMap, settings={"file": "maps/first.ply"})
    assert (ended.status, ended.reason) == ("SUCCESS", "40 points in maps/first.ply")
    saved = read_map(tmp_path / "maps" / "first.ply")
    np.testing.assert_array_equal(saved.cloud.points, POINTS)
    assert saved.cloud.frame == "map"
    np.testing.assert_array_equal(saved.T_map_base, np.eye(4))
    assert saved.stamp_s == pytest.approx(0.05)
    assert saved.datum is None
    (event,) = ended.events
    assert isinstance(event, MapSaved)
    assert (event.file, event.points, event.frame) == ("maps/first.ply", 40, "map")
    assert not list(tmp_path.rglob("*.partial"))


def test_an_empty_map_is_not_saved(stage, tmp_path) -> None:
    stand = stage.Stage(mapping=stage.PointMap([]), estimation=SimpleNamespace(map_origin=None))
    stand.leaf_context.run_folder = tmp_path
    ended = stand.tick(SaveMap)
    assert (ended.status, ended.reason) == ("FAILURE", "the map is empty: scan first")
    assert list(tmp_path.iterdir()) == []


def test_a_map_that_cannot_be_written_is_a_failure(site, tmp_path) -> None:
    (tmp_path / "maps").write_text("a file, no folder")
    ended = site.tick(SaveMap, settings={"file": "maps/first.ply"})
    assert ended.status == "FAILURE"
    assert "maps/first.ply cannot be written" in ended.reason
    assert ended.events == []


def test_a_saved_map_is_loaded_and_put_into_the_map(site, stage) -> None:
    site.tick(SaveMap)
    mapper = site.leaf_context.plugins["mapping"]
    mapper.points = np.zeros((0, 3))
    ended = site.tick(LoadMap, settings={"file": "saved_map.ply", "merge": True})
    assert (ended.status, ended.reason) == ("SUCCESS", "40 points from saved_map.ply")
    np.testing.assert_array_equal(mapper.points, POINTS)
    np.testing.assert_array_equal(ended.outputs["loaded_map"].points, POINTS)
    (event,) = ended.events
    assert isinstance(event, MapLoaded)
    assert (event.points, event.frame, event.is_merged) == (40, "map", True)


def saved_about(site, origin) -> None:
    """Save the map about an origin, and empty it."""
    site.leaf_context.plugins["estimation"].map_origin = origin
    assert site.tick(SaveMap).status == "SUCCESS"
    site.leaf_context.plugins["mapping"].points = np.zeros((0, 3))


def test_a_map_is_saved_with_its_origin_on_the_earth(site, tmp_path) -> None:
    site.leaf_context.plugins["estimation"].map_origin = HERE
    (event,) = site.tick(SaveMap).events
    assert event.datum == HERE
    np.testing.assert_array_equal(read_map(tmp_path / "saved_map.ply").datum, HERE)


@pytest.mark.parametrize("merge", [True, False])
def test_a_map_about_another_origin_is_brought_into_the_map(site, merge) -> None:
    east_up_m = np.array([3.0, -2.0, 0.5])
    saved_about(site, tuple(geodetic_from_enu(east_up_m, np.array(HERE))))
    site.leaf_context.plugins["estimation"].map_origin = HERE
    ended = site.tick(LoadMap, settings={"file": "saved_map.ply", "merge": merge})
    assert ended.status == "SUCCESS"
    points = ended.outputs["loaded_map"].points
    np.testing.assert_allclose(points, POINTS + east_up_m, atol=1e-5)  # the earth is round
    mapped = site.leaf_context.plugins["mapping"].points
    np.testing.assert_array_equal(mapped, points if merge else np.zeros((0, 3)))


@pytest.mark.parametrize(
    ("origin", "told"),
    [
        (None, "is about 47.408400°, 8.510600°, 440.0 m, and where this mission's map is is not"),
        ((47.5, 8.5106, 440.0), "its nearest point is 101"),
    ],
)
def test_a_map_that_is_elsewhere_is_not_put_into_the_map(site, origin, told) -> None:
    saved_about(site, HERE)
    site.leaf_context.plugins["estimation"].map_origin = origin
    ended = site.tick(LoadMap, settings={"file": "saved_map.ply", "merge": True})
    assert ended.status == "FAILURE"
    assert told in ended.reason
    assert len(site.leaf_context.plugins["mapping"].points) == 0
    assert site.tick(LoadMap, settings={"file": "saved_map.ply"}).status == "SUCCESS"


def test_a_map_of_a_file_without_an_origin_is_taken_as_of_this_mission(site, tmp_path) -> None:
    saved_about(site, HERE)
    beside = tmp_path / "saved_map.json"
    told = json.loads(beside.read_text())
    del told["datum"]
    beside.write_text(json.dumps(told))
    ended = site.tick(LoadMap, settings={"file": "saved_map.ply", "merge": True})
    assert ended.status == "SUCCESS"
    np.testing.assert_array_equal(site.leaf_context.plugins["mapping"].points, POINTS)


def test_a_cloud_of_another_program_keeps_a_frame_of_its_own(site, tmp_path) -> None:
    write_ply(tmp_path / "quarry.ply", POINTS, "whatever")
    ended = site.tick(LoadMap, settings={"file": "quarry.ply"})
    assert ended.status == "SUCCESS"
    assert ended.outputs["loaded_map"].frame == "quarry"
    assert len(site.leaf_context.plugins["mapping"].points) == 40  # the map is as it was


def test_a_file_of_a_name_that_is_too_long_is_a_failure(site) -> None:
    ended = site.tick(LoadMap, settings={"file": f"{'x' * 300}.ply"})
    assert ended.status == "FAILURE"
    assert "no such file" in ended.reason


def test_a_cloud_of_another_frame_is_not_put_into_the_map(site, tmp_path) -> None:
    write_ply(tmp_path / "quarry.ply", POINTS + 1.0, "whatever")
    ended = site.tick(LoadMap, settings={"file": "quarry.ply", "merge": True})
    assert (ended.status, ended.is_final) == ("FAILURE", True)
    assert "in the frame 'quarry', not in the map's: register it" in ended.reason
    np.testing.assert_array_equal(site.leaf_context.plugins["mapping"].points, POINTS)


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        (lambda path: path.unlink(), "no such file"),
        (lambda path: path.write_bytes(path.read_bytes()[:-9]), "saved_map.ply"),
        (lambda path: path.with_suffix(".json").write_text("{"), "not the description of a saved"),
        (
            lambda path: path.with_suffix(".json").write_text(
                json.dumps({"frame": "map", "stamp_s": 0.0, "T_map_base": [[1.0]]})
            ),
            "T_map_base",
        ),
        *[
            (
                lambda path, datum=datum: path.with_suffix(".json").write_text(
                    json.dumps(
                        {
                            "frame": "map",
                            "stamp_s": 0.0,
                            "T_map_base": None,
                            "datum": datum,
                        }
                    )
                ),
                "datum",
            )
            for datum in ([1.0, 2.0], [91.0, 8.0, 0.0])
        ],
    ],
)
def test_a_damaged_map_is_a_failure_with_the_place(site, tmp_path, damage, told) -> None:
    site.tick(SaveMap)
    damage(tmp_path / "saved_map.ply")
    ended = site.tick(LoadMap, settings={"file": "saved_map.ply"})
    assert ended.status == "FAILURE"
    assert told in ended.reason
    assert ended.outputs == {}
