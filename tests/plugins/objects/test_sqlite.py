"""The object database, on segments made here."""

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from executive_plugins.objects.association import associate_known_first
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.arrays import Float
from executive.errors import ConfigError, DataError, ShapeError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis, from_rpy
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.messages.stone import StoneState


def box(
    centre: tuple[float, float, float], sides: tuple[float, float, float] = (1.0, 0.7, 0.5)
) -> Float:
    """Points on the surface of a box, 5 cm apart."""
    axes = [np.arange(-s / 2, s / 2 + 1e-9, 0.05) for s in sides]
    grid = np.array(np.meshgrid(*axes)).reshape(3, -1).T
    on_face = (np.abs(np.abs(grid) - np.array(sides) / 2) < 1e-6).any(axis=1)
    return grid[on_face] + centre


def segment(points: Float, number: int = 0) -> Segment:
    return Segment(number, points, points.mean(axis=0), np.sort(np.ptp(points, axis=0))[::-1])


@pytest.fixture
def path(tmp_path: Path) -> str:
    return str(tmp_path / "objects.sqlite")


@pytest.fixture
def objects(path: str) -> Iterator[SqliteObjects]:
    database = SqliteObjects(SqliteObjectsSettings())
    database.start()
    database.open(path)
    yield database
    database.close()


def test_a_first_sight_gives_each_stone_a_number_and_a_frame_at_its_centroid(
    objects: SqliteObjects,
) -> None:
    a, b = objects.observe([segment(box((3, 0, 0))), segment(box((0, 4, 0)))], 1.0, False)
    assert (a.id, b.id) == (1, 2)
    assert a.state is StoneState.ON_GROUND
    np.testing.assert_allclose(a.T_map_object, pose(None, np.array([3.0, 0, 0])), atol=1e-9)
    np.testing.assert_allclose(a.centroid_map, [3, 0, 0], atol=0.01)


def test_the_same_stone_seen_again_keeps_its_number_whatever_the_order(
    objects: SqliteObjects,
) -> None:
    first = objects.observe([segment(box((3, 0, 0))), segment(box((0, 4, 0)))], 1.0, False)
    again = objects.observe([segment(box((0.05, 4, 0))), segment(box((3, 0.05, 0)))], 2.0, False)
    assert [stone.id for stone in again] == [first[1].id, first[0].id]
    assert len(objects.stones()) == 2


def test_a_new_view_adds_what_was_hidden(objects: SqliteObjects) -> None:
    whole = box((3, 0, 0))
    half = objects.observe([segment(whole[whole[:, 0] < 3])], 1.0, False)[0]
    full = objects.observe([segment(whole)], 2.0, True)[0]
    assert full.id == half.id
    assert np.ptp(half.points_map[:, 0]) < 0.6
    assert np.ptp(full.points_map[:, 0]) == pytest.approx(1.0, abs=0.05)
    assert full.seen_from_above
    assert not half.seen_from_above
    np.testing.assert_array_equal(full.T_map_object, half.T_map_object)


def test_a_surface_that_was_seen_elsewhere_replaces_the_known_one(objects: SqliteObjects) -> None:
    known = objects.observe([segment(box((3, 0, 0)))], 1.0, True)[0]
    objects.realign(1, pose(from_rpy(0, 0, 0.5), np.array([1.0, 0.0, 0.0])), 2.0)
    points = objects.stone(1).points_map[::3] + [0.0, 0.0, 0.02]
    shaped = objects.reshape(1, points, 3.0, "from below")
    np.testing.assert_allclose(shaped.points_map, points, atol=1e-5)
    np.testing.assert_array_equal(shaped.T_map_object, objects.history(1)[1].T_map_object)
    last = objects.history(1)[-1]
    assert (last.kind, last.note, last.state) == ("reshaped", "from below", known.state)
    with pytest.raises(DataError, match="without points"):
        objects.reshape(1, np.empty((0, 3)), 4.0)
    assert len(objects.stone(1).points_map) == len(points)


def test_two_merged_stones_are_not_one_that_has_grown(objects: SqliteObjects) -> None:
    objects.observe([segment(box((3, 0, 0)))], 1.0, False)
    merged = np.vstack([box((3, 0, 0)), box((4.2, 0, 0))])
    assert objects.observe([segment(merged)], 2.0, False)[0].id == 2


def test_a_piece_is_told_in_the_history_of_its_stone_and_changes_nothing(
    objects: SqliteObjects,
) -> None:
    whole = box((3, 0, 0))
    known = objects.observe([segment(whole)], 1.0, True)[0]
    ends = [whole[whole[:, 0] < 2.85] + [0, 0, 0.02], whole[whole[:, 0] > 3.05]]
    objects.observe([segment(points) for points in ends], 2.0, False)
    kinds = {event.kind: event.note for event in objects.history(known.id)}
    assert list(kinds) == ["found", "seen", "piece"]
    assert kinds["piece"].endswith("points in its body")
    assert len(objects.stones()) == 1
    np.testing.assert_array_equal(objects.stone(1).T_map_object, known.T_map_object)


@pytest.mark.parametrize(
    ("shift_m", "ids"),
    [
        ((0.0, 0.0, 0.55), [1, 2]),  # a stone that stands on it
        ((1.1, 0.0, 0.0), [1, 2]),  # one beside it
        ((0.65, 0.0, 0.0), [1, 2]),  # most of it lies outside
        ((0.45, 0.0, 0.0), [1, 1]),  # most of it lies inside: bodies do not share space
    ],
)
def test_a_body_that_is_mostly_outside_a_stone_is_another_stone(
    objects: SqliteObjects, shift_m: tuple[float, float, float], ids: list[int]
) -> None:
    known = box((3, 0, 0))
    objects.observe([segment(known)], 1.0, True)
    seen = objects.observe([segment(known), segment(known + shift_m)], 2.0, False)
    assert [stone.id for stone in seen] == ids


def test_release_moves_a_stone_as_the_gripper_moved(objects: SqliteObjects) -> None:
    stone = objects.observe([segment(box((5, 0, 0.3)))], 1.0, False)[0]
    T_grasp = pose(from_rpy(0.1, 1.5, 0.3), np.array([5.0, 0.1, 1.0]))
    T_release = pose(from_rpy(0.0, 1.4, 1.9), np.array([-1.0, 6.0, 1.2]))
    assert objects.grasp(stone.id, T_grasp, 2.0).state is StoneState.HELD
    placed = objects.release(stone.id, T_release, 3.0, StoneState.PLACED)
    T = T_release @ np.linalg.inv(T_grasp)  # Mascaro 2020, Eq. 3
    np.testing.assert_allclose(placed.T_map_object, T @ stone.T_map_object, atol=1e-9)
    np.testing.assert_allclose(placed.points_map, transform(T, stone.points_map), atol=1e-6)
    assert placed.state is StoneState.PLACED


def test_realign_moves_a_stone_and_is_remembered(objects: SqliteObjects) -> None:
    stone = objects.observe([segment(box((5, 0, 0.3)))], 1.0, False)[0]
    T = pose(about_axis(np.array([0, 0, 1.0]), 0.1), np.array([0.1, 0.2, 0.0]))
    realigned = objects.realign(stone.id, T, 4.0)
    np.testing.assert_allclose(realigned.T_map_object, T @ stone.T_map_object, atol=1e-12)
    history = objects.history(stone.id)
    assert [(event.stamp_s, event.kind) for event in history] == [(1.0, "found"), (4.0, "realign")]
    np.testing.assert_array_equal(history[0].T_map_object, stone.T_map_object)
    np.testing.assert_array_equal(history[1].T_map_object, realigned.T_map_object)


def test_a_held_stone_is_not_what_lies_where_it_was(objects: SqliteObjects) -> None:
    stone = objects.observe([segment(box((3, 0, 0)))], 1.0, False)[0]
    objects.grasp(stone.id, np.eye(4), 2.0)
    assert objects.observe([segment(box((3, 0, 0)))], 3.0, False)[0].id != stone.id


@pytest.mark.parametrize("state", [StoneState.ON_GROUND, StoneState.PLACED])
def test_a_stone_that_was_let_go_is_found_where_it_rolled_to(
    objects: SqliteObjects, state: StoneState
) -> None:
    """Let go on the ground, or set down on a slot and not seen there since."""
    stone = objects.observe([segment(box((3, 0, 0)))], 1.0, True)[0]
    objects.grasp(stone.id, np.eye(4), 2.0)
    objects.release(stone.id, np.eye(4), 3.0, state)
    tipped = box((4.5, 1, 0), sides=(0.5, 0.7, 1.0))
    found = objects.observe([segment(tipped)], 4.0, False)[0]
    assert found.id == stone.id
    np.testing.assert_allclose(found.centroid_map, [4.5, 1, 0], atol=0.01)
    assert np.ptp(found.points_map[:, 2]) == pytest.approx(
        1.0, abs=0.05
    )  # what is seen replaced what was known
    assert not found.seen_from_above
    elsewhere = objects.observe([segment(box((3, 0, 0)))], 5.0, False)[
        0
    ]  # and now it is known to lie there
    assert elsewhere.id != stone.id


def test_a_pebble_is_not_the_stone_that_rolled_away(objects: SqliteObjects) -> None:
    stone = objects.observe([segment(box((3, 0, 0)))], 1.0, True)[0]
    objects.set_state(stone.id, StoneState.LOST, 2.0)
    assert (
        objects.observe([segment(box((4.5, 0, 0), sides=(0.3, 0.3, 0.2)))], 3.0, False)[0].id
        != stone.id
    )
    assert objects.observe([segment(box((4.5, 1, 0)))], 4.0, False)[0].state is StoneState.ON_GROUND


def test_a_reopened_file_gives_the_same_stones(objects: SqliteObjects, path: str) -> None:
    objects.observe([segment(box((3, 0, 0))), segment(box((0, 4, 0)))], 1.0, True)
    objects.grasp(2, pose(None, np.array([0, 4.0, 1.0])), 2.0)
    before = objects.stones()
    objects.close()
    objects.open(path)
    for old, new in zip(before, objects.stones(), strict=True):
        assert (old.id, old.state, old.seen_from_above) == (new.id, new.state, new.seen_from_above)
        np.testing.assert_array_equal(old.points_map, new.points_map)
        np.testing.assert_array_equal(old.T_map_object, new.T_map_object)
    lifted = objects.release(2, pose(None, np.array([0, 4.0, 2.0])), 3.0, StoneState.PLACED)
    np.testing.assert_allclose(lifted.centroid_map, [0, 4, 1], atol=0.01)


def test_grasps_that_held_a_stone_are_kept_with_it(objects: SqliteObjects, path: str) -> None:
    one, _ = objects.observe([segment(box((3, 0, 0))), segment(box((0, 4, 0)))], 1.0, True)
    assert one.T_object_gripper.shape == (0, 4, 4)
    first, second = pose(t=np.array([0.0, 0.1, 0.9])), pose(from_rpy(0.1, 0.2, 0.3))
    objects.keep_grasp(one.id, first, 2.0)
    objects.keep_grasp(one.id, second, 3.0)
    objects.close()
    objects.open(path)
    np.testing.assert_array_equal(objects.stone(one.id).T_object_gripper, [first, second])
    assert len(objects.stones()[1].T_object_gripper) == 0
    with pytest.raises(DataError, match="no stone 3"):
        objects.keep_grasp(3, first, 4.0)
    with pytest.raises(ShapeError, match="T_object_gripper"):
        objects.keep_grasp(one.id, first[:3], 4.0)


def test_a_file_of_an_older_run_has_no_grasps_and_takes_some(
    objects: SqliteObjects, path: str
) -> None:
    objects.observe([segment(box((3, 0, 0)))], 1.0, True)
    objects.close()
    with closing(sqlite3.connect(path)) as older:
        assert older.execute("SELECT 1 FROM sqlite_master WHERE name = 'grasps'").fetchone() is None
    objects.open(path)
    assert len(objects.stone(1).T_object_gripper) == 0
    assert len(objects.keep_grasp(1, np.eye(4), 2.0).T_object_gripper) == 1


def test_what_returned_is_on_the_disk_for_another_reader(objects: SqliteObjects, path: str) -> None:
    objects.observe([segment(box((3, 0, 0)))], 1.0, True)
    other = sqlite3.connect(
        f"file:{path}?mode=ro", uri=True
    )  # while the first is still open, as after a kill
    assert other.execute("SELECT id, state FROM stones").fetchall() == [(1, "on_ground")]
    other.close()


def test_a_failed_change_leaves_nothing_behind(objects: SqliteObjects) -> None:
    good = segment(box((3, 0, 0)))
    objects.observe([good], 1.0, False)
    objects._connection().execute(
        "CREATE TRIGGER no_more BEFORE INSERT ON events BEGIN SELECT RAISE(ABORT, 'full'); END"
    )
    with pytest.raises(sqlite3.IntegrityError, match="full"):
        objects.observe([segment(box((0, 4, 0)))], 2.0, False)
    assert [stone.id for stone in objects.stones()] == [1]


def test_wrong_requests_say_what_is_wrong(objects: SqliteObjects) -> None:
    objects.observe([segment(box((3, 0, 0)))], 1.0, False)
    with pytest.raises(DataError, match=r"no stone 7 .* there is 1"):
        objects.stone(7)
    with pytest.raises(DataError, match="only a held stone can be released"):
        objects.release(1, np.eye(4), 2.0, StoneState.PLACED)
    with pytest.raises(DataError, match="use `grasp` to hold it"):
        objects.set_state(1, StoneState.HELD, 2.0)
    objects.grasp(1, np.eye(4), 2.0)
    with pytest.raises(DataError, match="held already"):
        objects.grasp(1, np.eye(4), 3.0)


def test_wrong_files_say_what_is_wrong(tmp_path: Path) -> None:
    database = SqliteObjects(SqliteObjectsSettings())
    with pytest.raises(ConfigError, match="not open"):
        database.stones()
    with pytest.raises(ConfigError, match="create"):
        database.open(str(tmp_path / "nowhere" / "objects.sqlite"))
    text = tmp_path / "text.sqlite"
    text.write_text("this is no database, but long enough to be taken for one " * 20)
    with pytest.raises(DataError, match="not an object database"):
        database.open(str(text))
    other = tmp_path / "other.sqlite"
    connection = sqlite3.connect(other)
    connection.execute("CREATE TABLE songs (title TEXT)")
    connection.commit()
    connection.close()
    with pytest.raises(DataError, match="version"):
        database.open(str(other))


def test_the_database_does_not_wait_for_a_thread_that_computes_surroundings(
    objects: SqliteObjects, monkeypatch: pytest.MonkeyPatch
) -> None:
    (stone,) = objects.observe([segment(box((5.0, 0.0, 0.3)))], 1.0, False)
    begun, go_on = threading.Event(), threading.Event()

    def slowly(points: Float, *_: object) -> Float:
        begun.set()
        assert go_on.wait(60.0)
        return points

    monkeypatch.setattr("executive_plugins.objects.sqlite.surroundings", slowly)
    ground, found = Cloud("map", np.zeros((4, 3))), list[Cloud]()
    asking = threading.Thread(
        target=lambda: found.append(objects.surroundings(ground)), daemon=True
    )
    asking.start()
    assert begun.wait(60.0)
    objects.set_state(stone.id, StoneState.PLACED, 2.0)  # would wait for ever
    assert objects.stone(stone.id).state is StoneState.PLACED
    go_on.set()
    asking.join()
    assert len(found[0]) == 4


def test_stones_are_read_and_not_changed_while_a_thread_compares_them_with_segments(
    objects: SqliteObjects, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = box((5.0, 0.0, 0.3))
    (stone,) = objects.observe([segment(points)], 1.0, False)
    begun, go_on, compare = threading.Event(), threading.Event(), associate_known_first

    def slowly(*given: Any) -> Any:
        begun.set()
        assert go_on.wait(60.0)
        return compare(*given)

    monkeypatch.setattr("executive_plugins.objects.sqlite.associate_known_first", slowly)
    seen = threading.Thread(
        target=lambda: objects.observe([segment(points)], 2.0, False), daemon=True
    )
    seen.start()
    assert begun.wait(60.0)
    assert len(objects.stones()) == 1  # would wait for ever
    grasp = threading.Thread(target=lambda: objects.grasp(stone.id, np.eye(4), 3.0), daemon=True)
    grasp.start()
    grasp.join(0.1)
    assert objects.stone(stone.id).state is StoneState.ON_GROUND
    go_on.set()
    for thread in (seen, grasp):
        thread.join(60.0)
    assert [one.kind for one in objects.history(stone.id)] == ["found", "seen", "grasp"]


def test_a_database_that_is_open_is_not_opened_again(
    objects: SqliteObjects, tmp_path: Path
) -> None:
    other = str(tmp_path / "other.sqlite")
    with pytest.raises(ConfigError, match=r"is open already; close it before opening .*other"):
        objects.open(other)
    assert not Path(other).exists()
    objects.observe([segment(box((3, 0, 0)))], 1.0, False)  # the first one is open still
    objects.close()
    objects.close()
    objects.open(other)
    assert Path(other).exists()


def test_a_stone_that_there_is_not_has_no_history(objects: SqliteObjects) -> None:
    objects.observe([segment(box((3, 0, 0)))], 1.0, False)
    assert [event.kind for event in objects.history(1)] == ["found"]
    with pytest.raises(DataError, match="2"):
        objects.history(2)


def test_a_database_that_is_closed_is_closed_for_whoever_still_holds_it(path: str) -> None:
    database = SqliteObjects(SqliteObjectsSettings())
    database.open(path)
    held = database._connection()
    database.close()
    with pytest.raises(sqlite3.ProgrammingError, match="closed"):
        held.execute("SELECT 1")
    database.open(path)  # it may be opened again
    assert database.stones() == ()
    database.close()
    database.close()
