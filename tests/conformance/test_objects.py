"""What every object database must do, whatever its store."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from executive import registry
from executive.errors import ConfigError, DataError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.interfaces.objects import ObjectDatabase
from executive.messages.segment import Segment
from executive.messages.stone import StoneState

T_GRASP = pose(from_rpy(0.1, 1.5, 0.3), np.array([5.0, 0.1, 1.0]))
T_RELEASE = pose(from_rpy(0.0, 1.4, 1.9), np.array([-1.0, 6.0, 1.2]))


@pytest.fixture(params=[plugin.name for plugin in registry.installed("objects")])
def make_database(request: pytest.FixtureRequest) -> Callable[[], ObjectDatabase]:
    plugin = registry.load("objects", request.param)

    def make() -> ObjectDatabase:
        services = {"rng": np.random.default_rng(0)}
        database: ObjectDatabase = plugin(
            plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin))
        )
        database.start()
        request.addfinalizer(database.close)
        return database

    return make


@pytest.fixture
def database(make_database: Callable[[], ObjectDatabase]) -> ObjectDatabase:
    made = make_database()
    made.open(":memory:")
    return made


def boulder(x: float, y: float) -> Segment:
    d = np.random.default_rng(0).normal(size=(2000, 3))
    points = 0.5 * d / np.linalg.norm(d, axis=1)[:, None] * [1, 0.8, 0.7] + [x, y, 0.3]
    return Segment(0, points, points.mean(axis=0), np.array([1.0, 0.8, 0.7]))


def test_a_new_database_is_empty(database: ObjectDatabase) -> None:
    assert isinstance(database, ObjectDatabase)
    assert database.stones() == ()
    assert database.observe([], 0.0, False) == ()


def test_stones_are_numbered_from_one_and_recognised(database: ObjectDatabase) -> None:
    first = database.observe([boulder(3, 0), boulder(0, 4)], 1.0, False)
    again = database.observe([boulder(0, 4), boulder(3, 0), boulder(-4, 0)], 2.0, True)
    assert [stone.id for stone in first] == [1, 2]
    assert [stone.id for stone in again] == [2, 1, 3]
    assert [stone.id for stone in database.stones()] == [1, 2, 3]
    assert all(stone.seen_from_above for stone in database.stones())
    assert {stone.state for stone in database.stones()} == {StoneState.ON_GROUND}


def test_the_object_frame_begins_at_the_centroid_along_the_maps_axes(
    database: ObjectDatabase,
) -> None:
    segment = boulder(3, 0)
    stone = database.observe([segment], 1.0, False)[0]
    np.testing.assert_allclose(stone.T_map_object, pose(None, segment.centroid), atol=1e-6)
    np.testing.assert_allclose(stone.centroid_map, stone.points_map.mean(axis=0), atol=1e-9)


def test_a_release_moves_the_stone_by_the_grippers_motion(database: ObjectDatabase) -> None:
    stone = database.observe([boulder(5, 0)], 1.0, False)[0]
    assert database.grasp(1, T_GRASP, 2.0).state is StoneState.HELD
    moved = database.release(1, T_RELEASE, 3.0, StoneState.PLACED)
    T = T_RELEASE @ np.linalg.inv(T_GRASP)
    assert moved.state is StoneState.PLACED
    np.testing.assert_allclose(moved.T_map_object, T @ stone.T_map_object, atol=1e-6)
    np.testing.assert_allclose(moved.points_map, transform(T, stone.points_map), atol=1e-5)


def test_a_realignment_moves_the_stone_in_the_map(database: ObjectDatabase) -> None:
    stone = database.observe([boulder(5, 0)], 1.0, False)[0]
    T = pose(from_rpy(0, 0, 0.2), np.array([0.1, 0, 0]))
    np.testing.assert_allclose(
        database.realign(1, T, 2.0).T_map_object, T @ stone.T_map_object, atol=1e-6
    )


def test_a_state_changes_alone(database: ObjectDatabase) -> None:
    before = database.observe([boulder(5, 0)], 1.0, False)[0]
    after = database.set_state(1, StoneState.SET_ASIDE, 2.0)
    assert after.state is StoneState.SET_ASIDE
    np.testing.assert_array_equal(after.points_map, before.points_map)
    np.testing.assert_array_equal(after.T_map_object, before.T_map_object)


def test_an_unknown_stone_is_an_error(database: ObjectDatabase) -> None:
    for act in (
        lambda: database.stone(9),
        lambda: database.history(9),
        lambda: database.grasp(9, np.eye(4), 1.0),
        lambda: database.realign(9, np.eye(4), 1.0),
        lambda: database.set_state(9, StoneState.LOST, 1.0),
    ):
        with pytest.raises(DataError, match="9"):
            act()


def test_a_reopened_file_gives_the_same_stones(
    make_database: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    path = str(tmp_path / "objects.db")
    first = make_database()
    first.open(path)
    first.observe([boulder(5, 0), boulder(0, 4)], 1.0, False)
    first.grasp(1, T_GRASP, 2.0)
    kept = first.stones()
    first.close()
    second = make_database()
    second.open(path)
    for a, b in zip(kept, second.stones(), strict=True):
        assert (a.id, a.state) == (b.id, b.state)
        np.testing.assert_array_equal(a.points_map, b.points_map)
        np.testing.assert_array_equal(a.T_map_object, b.T_map_object)


def test_another_may_look_while_it_is_open(
    make_database: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    path = str(tmp_path / "objects.db")
    writer, reader = make_database(), make_database()
    writer.open(path)
    writer.observe([boulder(5, 0)], 1.0, False)
    reader.open(path, read_only=True)
    assert [stone.id for stone in reader.stones()] == [1]
    writer.set_state(1, StoneState.LOST, 2.0)
    assert reader.stone(1).state is StoneState.LOST
    with pytest.raises(ConfigError):
        reader.set_state(1, StoneState.PLACED, 3.0)


def test_a_file_to_look_at_must_be_there(
    make_database: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    with pytest.raises(ConfigError):
        make_database().open(str(tmp_path / "objects.db"), read_only=True)


def test_the_history_tells_every_change_with_state_and_pose(database: ObjectDatabase) -> None:
    first = database.observe([boulder(5, 0)], 1.0, False)[0]
    changes = [
        database.grasp(1, T_GRASP, 2.0),
        database.release(1, T_RELEASE, 3.0, StoneState.PLACED),
        database.realign(1, pose(None, np.array([0.1, 0, 0])), 4.0, "overlap 0.9"),
        database.set_state(1, StoneState.ON_GROUND, 5.0),
    ]
    history = database.history(1)
    assert [event.stamp_s for event in history] == [1.0, 2.0, 3.0, 4.0, 5.0]
    assert history[3].note == "overlap 0.9"
    for event, stone in zip(history, [first, *changes], strict=True):
        assert event.state is stone.state
        np.testing.assert_array_equal(event.T_map_object, stone.T_map_object)


def test_a_folder_that_is_not_there_is_an_error(
    make_database: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    with pytest.raises(ConfigError):
        make_database().open(str(tmp_path / "nowhere" / "objects.db"))
