"""When a view joins a stone's model, and when it does not: a wrong one must never poison it."""

from collections.abc import Iterator

import numpy as np
import pytest
from executive_plugins.objects.growth import fit_of, merged
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis
from executive.geometry.voxels import voxel_means
from executive.messages.segment import Segment

Z = np.array([0.0, 0.0, 1.0])


def block(centre: tuple[float, float, float], seed: int = 0, count: int = 4000) -> Float:
    """Points on the faces of a block of 1 × 0.7 × 0.5 m, 5 mm of noise."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.5, 0.5, (count, 3))
    face = rng.integers(0, 3, count)
    points[np.arange(count), face] = np.sign(points[np.arange(count), face]) * 0.5
    return points * [1.0, 0.7, 0.5] + rng.normal(0, 0.005, points.shape) + centre


def segment(points: Float) -> Segment:
    return Segment(0, points, points.mean(axis=0), np.sort(np.ptp(points, axis=0))[::-1])


@pytest.fixture
def objects() -> Iterator[SqliteObjects]:
    database = SqliteObjects(SqliteObjectsSettings())
    database.open(":memory:")
    yield database
    database.close()


def test_a_fit_is_the_same_from_every_frame() -> None:
    model, view = block((3, 0, 0)), block((3.02, 0, 0), seed=1)
    T = pose(about_axis(Z, 1.1), np.array([5.0, -3.0, 1.0]))
    near, far = fit_of(model, view, 0.1), fit_of(transform(T, model), transform(T, view), 0.1)
    assert near.share == pytest.approx(far.share)
    assert near.rmse_m == pytest.approx(far.rmse_m)


def test_half_a_view_fits_wholly_and_a_stranger_does_not() -> None:
    model = block((3, 0, 0))
    half = block((3, 0, 0), seed=1)
    assert fit_of(model, half[half[:, 0] < 3], 0.1).share == 1.0
    assert fit_of(model, half + [0, 0.6, 0], 0.1).share < 0.5


def test_a_surface_with_too_many_points_keeps_at_least_half_of_the_bound() -> None:
    """Each step of the grid doubles the volume of a cell: on a surface the count falls by 1.6."""
    points = block((0.0, 0.0, 0.0), count=60_000)
    assert 1000 < len(merged(points[:0], points, 0.01, 2000)) <= 2000


def test_a_merged_surface_is_bounded_whatever_comes() -> None:
    rng = np.random.default_rng(0)
    assert (
        len(merged(rng.uniform(0, 3, (50_000, 3)), rng.uniform(0, 3, (50_000, 3)), 0.03, 5000))
        <= 5000
    )


def test_twenty_views_neither_thicken_nor_lose_a_stone(objects: SqliteObjects) -> None:
    objects.observe([segment(block((3, 0, 0)))], 0.0, True)
    views = [segment(block((3, 0, 0), seed=i)) for i in range(20)]
    sizes = [len(objects.observe([view], 1.0, False)[0].points_map) for view in views]
    assert max(sizes[3:]) < 1.15 * min(sizes[3:])
    final = objects.stone(1).points_map - [3, 0, 0]
    off = np.min(np.abs(np.abs(final) - [0.5, 0.35, 0.25]), axis=1)
    assert np.percentile(off, 99) < 0.03


def test_what_a_turned_stone_shows_anew_joins_its_model_in_its_own_frame(
    objects: SqliteObjects,
) -> None:
    whole = block((3, 0, 0))
    objects.observe([segment(whole[whole[:, 2] > -0.1])], 0.0, False)
    T = pose(
        about_axis(np.array([1.0, 0, 0]), np.pi), np.array([0, 4.0, 0.5])
    )  # upside down, elsewhere
    objects.grasp(1, np.eye(4), 1.0)
    objects.release(1, T, 2.0, objects.stone(1).state.PLACED)
    seen = transform(T, block((3, 0, 0), seed=1))
    stone = objects.observe([segment(seen[seen[:, 2] > 0.4])], 3.0, False)[0]
    assert stone.id == 1
    own = transform(inverse(stone.T_map_object), stone.points_map)
    assert np.ptp(own[:, 2]) == pytest.approx(0.5, abs=0.05)
    assert np.ptp(own, axis=0)[:2] == pytest.approx([1.0, 0.7], abs=0.05)


def test_a_view_of_two_stones_in_one_adds_nothing_to_a_whole_model(objects: SqliteObjects) -> None:
    objects.observe([segment(block((3, 0, 0)))], 0.0, True)
    before = objects.stone(1)
    both = np.vstack([block((3, 0, 0), seed=1), block((3, 0.45, 0), seed=2)])
    after = objects.observe([segment(both)], 1.0, False)[0]
    assert after.id == 1
    np.testing.assert_array_equal(after.points_map, before.points_map)
    assert "too much, nothing added" in objects.history(1)[-1].note


def test_a_view_of_a_drifting_map_does_not_blur_the_model(objects: SqliteObjects) -> None:
    """Surfaces 6 cm apart overlap within 10 cm; their RMSE tells that they do not agree."""
    model = block((3, 0, 0), count=20_000)
    first = objects.observe([segment(model)], 0.0, True)[0]
    objects.observe([segment(model + 0.06)], 1.0, False)
    stone = objects.stone(1)
    off = np.min(
        np.abs(
            np.abs(transform(inverse(stone.T_map_object), stone.points_map)) - [0.5, 0.35, 0.25]
        ),
        axis=1,
    )
    assert np.percentile(off, 99) < 0.03
    assert objects.history(1)[-1].kind == "moved"
    np.testing.assert_allclose(
        stone.T_map_object[:3, 3] - first.T_map_object[:3, 3], 0.06, atol=0.01
    )


def test_each_view_is_told_where_it_came_from_and_how_it_fitted(objects: SqliteObjects) -> None:
    objects.observe([segment(block((3, 0, 0)))], 0.0, True)
    objects.observe([segment(block((3, 0, 0), seed=1))], 1.0, False)
    first, second = objects.history(1)
    assert (first.kind, first.note) == ("found", "lidar and drone")
    assert second.kind == "seen"
    assert second.note.startswith("lidar, overlap 1.00, rmse ")


def test_a_pushed_stone_keeps_its_whole_model(objects: SqliteObjects) -> None:
    objects.observe([segment(block((3, 0, 0)))], 0.0, True)
    stone = objects.observe([segment(block((3.3, 0.3, 0), seed=1))], 1.0, False)[0]
    assert (stone.id, stone.seen_from_above) == (1, True)
    assert objects.history(1)[-1].kind == "moved"
    np.testing.assert_allclose(stone.points_map.mean(axis=0), [3.3, 0.3, 0], atol=0.02)


def test_a_stone_seen_from_one_side_a_little_off_keeps_its_whole_model(
    objects: SqliteObjects,
) -> None:
    """Mean and box of such a view are those of the side; the model used to be given up for it."""
    objects.observe([segment(block((3, 0, 0)))], 0.0, True)
    side = block((0, 0, 0), seed=1, count=8000)
    side = side[(side[:, 2] > 0.0) & ((side[:, 0] > 0.45) | (side[:, 2] > 0.2))]
    off = pose(about_axis(Z, np.radians(2.0)), np.array([3.05, 0.045, 0.065]))
    stone = objects.observe([segment(transform(off, side))], 1.0, False)[0]
    assert objects.history(1)[-1].kind == "moved"
    assert stone.seen_from_above
    np.testing.assert_allclose(stone.T_map_object[:3, 3], [3.05, 0.045, 0.065], atol=0.04)
    np.testing.assert_allclose(np.ptp(stone.points_map, axis=0), [1.0, 0.7, 0.5], atol=0.08)


def test_a_turned_stone_is_seen_afresh(objects: SqliteObjects) -> None:
    objects.observe([segment(block((3, 0, 0)))], 0.0, True)
    turned = transform(
        pose(about_axis(np.array([0, 1.0, 0]), np.pi / 2), np.array([3.2, 0, 3.0])),
        block((3, 0, 0), 1),
    )
    stone = objects.observe([segment(turned - turned.mean(axis=0) + [3.2, 0, 0])], 1.0, False)[0]
    assert (stone.id, stone.seen_from_above) == (1, False)
    assert objects.history(1)[-1].kind == "replaced"
    assert np.ptp(stone.points_map[:, 2]) == pytest.approx(1.0, abs=0.06)


def test_a_grasp_that_held_a_stone_is_forgotten_once_it_is_seen_afresh(
    objects: SqliteObjects,
) -> None:
    """Nobody knows how the new surface lies to the old one, in whose frame the grasp is."""
    objects.observe([segment(block((3, 0, 0)))], 0.0, True)
    objects.keep_grasp(1, np.eye(4), 0.5)
    pushed = objects.observe([segment(block((3.1, 0, 0)))], 1.0, False)[0]
    assert objects.history(1)[-1].kind == "moved"
    assert len(pushed.T_object_gripper) == 1
    turned = transform(pose(about_axis(np.array([0, 1.0, 0]), np.pi / 2)), block((0, 0, 0), 1))
    stone = objects.observe([segment(turned + [3.2, 0, 0])], 2.0, False)[0]
    assert objects.history(1)[-1].kind == "replaced"
    assert len(stone.T_object_gripper) == 0


def test_the_frame_of_a_replaced_stone_moves_by_the_means_of_both_views(
    objects: SqliteObjects,
) -> None:
    """Box centres differ from means where a view is one-sided; no fit decides between them."""
    first = objects.observe([segment(block((3, 0, 0)))], 0.0, True)[0]
    turned = transform(pose(about_axis(np.array([0, 1.0, 0]), np.pi / 2)), block((0, 0, 0), 1))
    one_sided = turned[turned[:, 0] < 0.1] + [3.3, 0.0, 0.0]
    stone = objects.observe([segment(one_sided)], 1.0, False)[0]
    assert objects.history(1)[-1].kind == "replaced"
    expected = voxel_means(one_sided, 0.03).mean(axis=0) - first.points_map.mean(axis=0)
    moved = stone.T_map_object[:3, 3] - first.T_map_object[:3, 3]
    np.testing.assert_allclose(moved, expected, atol=1e-6)


def test_a_model_of_just_as_many_points_as_are_allowed_stays_as_it_is() -> None:
    model = np.mgrid[0:6, 0:5, 0:4].reshape(3, -1).T * 0.1
    near = model + 0.004  # within a cell: nothing of it is new
    assert np.array_equal(merged(model, near, 0.01, len(model)), model)
    assert len(merged(model, near, 0.01, len(model) - 1)) < len(model)
