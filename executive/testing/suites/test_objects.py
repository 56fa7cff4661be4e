"""What every object database must do, whatever its store."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from executive.arrays import Float
from executive.errors import ConfigError, DataError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.interfaces.objects import ObjectDatabase
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.messages.stone import StoneState
from executive.testing.exercises.objects import T_GRASP, T_RELEASE, boulder

CAPABILITY = "objects"


@pytest.fixture
def database(plugin: ObjectDatabase) -> ObjectDatabase:
    """A database that keeps nothing on the disk."""
    plugin.open(":memory:")
    return plugin


def test_a_new_database_is_empty(database: ObjectDatabase) -> None:
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


def test_pieces_of_a_known_stone_are_no_stones_of_their_own(database: ObjectDatabase) -> None:
    """The map shows parts of a stone where other parts were removed from it."""
    whole = boulder(3, 0)
    database.observe([whole], 1.0, False)
    is_left = whole.points[:, 0] < whole.centroid[0]
    halves = [
        Segment(number, points, points.mean(axis=0), np.sort(np.ptp(points, axis=0))[::-1])
        for number, points in enumerate((whole.points[is_left], whole.points[~is_left]))
    ]
    assert [stone.id for stone in database.observe(halves, 2.0, False)] == [1, 1]
    assert [stone.id for stone in database.stones()] == [1]


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


def test_another_surface_leaves_a_stone_where_it_is(database: ObjectDatabase) -> None:
    """A database that does not keep surfaces that others found returns the stone as it was."""
    before = database.observe([boulder(5, 0)], 1.0, False)[0]
    database.grasp(1, T_GRASP, 2.0)
    after = database.reshape(1, before.points_map[::2], 3.0, "from below")
    assert after.state is StoneState.HELD
    np.testing.assert_array_equal(after.T_map_object, before.T_map_object)
    if len(after.points_map) != len(before.points_map):
        np.testing.assert_allclose(after.points_map, before.points_map[::2], atol=1e-5)
    moved = database.release(1, T_RELEASE, 4.0, StoneState.PLACED)
    assert len(moved.points_map) == len(after.points_map)


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
        lambda: database.reshape(9, np.zeros((1, 3)), 1.0),
        lambda: database.set_state(9, StoneState.LOST, 1.0),
    ):
        with pytest.raises(DataError, match="9"):
            act()


def test_a_reopened_file_gives_the_same_stones(
    make: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    path = str(tmp_path / "objects.db")
    first = make()
    first.open(path)
    first.observe([boulder(5, 0), boulder(0, 4)], 1.0, False)
    first.grasp(1, T_GRASP, 2.0)
    kept = first.stones()
    first.close()
    second = make()
    second.open(path)
    for a, b in zip(kept, second.stones(), strict=True):
        assert (a.id, a.state) == (b.id, b.state)
        np.testing.assert_array_equal(a.points_map, b.points_map)
        np.testing.assert_array_equal(a.T_map_object, b.T_map_object)


def test_another_may_look_while_it_is_open(
    make: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    path = str(tmp_path / "objects.db")
    writer, reader = make(), make()
    writer.open(path)
    writer.observe([boulder(5, 0)], 1.0, False)
    reader.open(path, read_only=True)
    assert [stone.id for stone in reader.stones()] == [1]
    writer.set_state(1, StoneState.LOST, 2.0)
    assert reader.stone(1).state is StoneState.LOST
    with pytest.raises(ConfigError):
        reader.set_state(1, StoneState.PLACED, 3.0)


def test_a_file_to_look_at_must_be_there(
    make: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    with pytest.raises(ConfigError):
        make().open(str(tmp_path / "objects.db"), read_only=True)


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
    make: Callable[[], ObjectDatabase], tmp_path: Path
) -> None:
    with pytest.raises(ConfigError):
        make().open(str(tmp_path / "nowhere" / "objects.db"))


def scene(database: ObjectDatabase) -> Cloud:
    """Two lying stones 1.1 m apart, one held between them, and the map that shows all three."""
    boulders = [boulder(5, 0), boulder(6.1, 0), boulder(5.5, 0.8)]
    database.observe(boulders, 1.0, False)
    database.grasp(3, T_GRASP, 2.0)
    xy = np.random.default_rng(1).uniform(-3, 3, (20_000, 2)) + [5.5, 0.0]
    ground = np.column_stack([xy, np.full(len(xy), -0.03)])
    return Cloud("map", np.vstack([ground, *(b.points for b in boulders)]))


def within(points: Float, centre: Float, radius_m: float) -> int:
    return int((np.linalg.norm(points - centre, axis=1) < radius_m).sum())


def test_the_surroundings_show_lying_stones_that_the_map_has_forgotten(
    database: ObjectDatabase,
) -> None:
    cloud = scene(database)
    ground = Cloud("map", cloud.points[cloud.points[:, 2] < -0.02])
    merged = database.surroundings(ground)
    assert merged.frame == "map"
    tops = merged.points[merged.points[:, 2] > 0.4]
    for stone in database.stones():
        count = within(tops, stone.centroid_map, 0.55)
        assert (count > 100) == stone.state.is_lying or stone.id == 3
    assert not within(tops, database.stone(3).centroid_map + [0.0, 0.3, 0.0], 0.15)


def test_the_surroundings_leave_out_one_stone_and_keep_the_ground_under_it(
    database: ObjectDatabase,
) -> None:
    cloud = scene(database)
    whole, less = database.surroundings(cloud), database.surroundings(cloud, without=2)
    own = database.stone(2)
    top = own.centroid_map + [0.3, 0.0, 0.25]
    assert within(whole.points, top, 0.2) > 20
    assert within(less.points, top, 0.2) == 0
    under = np.array([*own.centroid_map[:2], -0.03])
    assert within(less.points, under, 0.2) > 0.9 * within(whole.points, under, 0.2) > 50
    with pytest.raises(DataError, match="9"):
        database.surroundings(cloud, without=9)


def test_what_lying_neighbours_explain_is_left_out_but_not_ground_nor_what_is_held(
    database: ObjectDatabase,
) -> None:
    cloud = scene(database)
    left = database.unexplained(cloud, 1, 2.0)
    assert left.frame == "map"
    centre = database.stone(1).centroid_map[:2]
    assert np.hypot(*(left.points[:, :2] - centre).T).max() < 2.0
    neighbour, held = database.stone(2), database.stone(3)
    high = left.points[left.points[:, 2] > 0.15]
    assert within(high, neighbour.centroid_map + [0.2, -0.1, 0.2], 0.2) == 0
    assert within(high, held.centroid_map + [0.0, 0.3, 0.0], 0.3) > 50
    assert within(high, database.stone(1).centroid_map, 0.6) > 300
    near = np.hypot(*(cloud.points[:, :2] - centre).T) < 2.0
    # Ground below a neighbour is hidden by it: that it was seen before may be left out as well.
    beside = np.hypot(*(cloud.points[:, :2] - neighbour.centroid_map[:2]).T) > neighbour.reach_m
    is_ground = cloud.points[near & beside]
    is_ground = is_ground[is_ground[:, 2] < -0.02]
    assert {tuple(point) for point in is_ground} <= {tuple(point) for point in left.points}
    with pytest.raises(DataError, match="9"):
        database.unexplained(cloud, 9, 2.0)


def test_the_foot_of_a_neighbour_that_rests_on_a_stone_is_no_ground(
    database: ObjectDatabase,
) -> None:
    base, upper, beside = boulder(5, 0), boulder(5.4, 0), boulder(6.4, 0)
    rise = np.array([0.0, 0.0, np.ptp(base.points[:, 2])])
    raised = replace(upper, points=upper.points + rise, centroid=upper.centroid + rise)
    database.observe([base, raised, beside], 1.0, False)
    cloud = Cloud("map", np.vstack([base.points, raised.points, beside.points]))
    left = database.unexplained(cloud, 1, 2.0)
    assert within(left.points, base.points.mean(axis=0), 0.6) > 300
    high = left.points[:, 2] > base.points[:, 2].max() + 0.02
    assert not high.any()


def test_what_a_sphere_takes_from_lying_stones_is_known(database: ObjectDatabase) -> None:
    scene(database)
    centre = database.stone(1).centroid_map
    cut = database.surface_within(centre, 0.8, without=1)
    model = database.stone(2).points_map  # the held one is nearer, and not in the map
    expected = model[np.linalg.norm(model - centre, axis=1) <= 0.8]
    assert len(expected) > 20
    np.testing.assert_array_equal(cut, expected)
    assert len(database.surface_within(centre, 0.8)) == len(cut) + len(database.stone(1).points_map)
    assert database.surface_within(np.array([50.0, 0, 0]), 1.0).shape == (0, 3)
