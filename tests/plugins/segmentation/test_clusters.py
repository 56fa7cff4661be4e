"""Connected voxels, against a search by distance."""

import numpy as np
import pytest
from executive_plugins.segmentation.clusters import _slot
from executive_plugins.segmentation.clusters import connected_clusters as clusters_within
from scipy.cluster.hierarchy import fcluster, linkage


def connected_clusters(points: np.ndarray, voxel_m: float) -> np.ndarray:
    return clusters_within(points, np.zeros(len(points), dtype=np.int64), voxel_m)


def partition(labels: np.ndarray) -> set[frozenset[int]]:
    return {frozenset(np.flatnonzero(labels == label)) for label in np.unique(labels)}


def test_blobs_apart_are_told_as_single_linkage_tells_them() -> None:
    rng = np.random.default_rng(0)
    centres = np.array([[0, 0, 0], [1, 0, 0], [0, 1.2, 0], [3, 3, 1]])
    points = np.vstack([centre + rng.uniform(-0.3, 0.3, (400, 3)) for centre in centres])
    expected = fcluster(linkage(points, "single"), 0.2, "distance")
    assert partition(connected_clusters(points, 0.15)) == partition(expected)


@pytest.mark.parametrize(("gap_m", "count"), [(0.09, 1), (0.21, 2)])
def test_gaps_below_a_voxel_join_and_above_two_separate(gap_m: float, count: int) -> None:
    for shift in np.linspace(0, 0.1, 7):
        points = np.array([[shift, 0, 0], [shift + gap_m, 0, 0], [0.0, 0, 0]])[
            : 2 + (gap_m < 0.1 and shift < 0.1)
        ]
        assert len(np.unique(connected_clusters(points, 0.1))) == count


def test_the_partition_does_not_depend_on_the_order_of_points() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(0, 2, (600, 3))
    order = rng.permutation(len(points))
    labels = connected_clusters(points, 0.12)
    shuffled = np.empty_like(labels)
    shuffled[order] = connected_clusters(points[order], 0.12)
    assert partition(shuffled) == partition(labels)
    assert 1 < len(partition(labels)) < 600


def test_no_points_have_no_clusters() -> None:
    assert connected_clusters(np.empty((0, 3)), 0.1).shape == (0,)


def test_groups_do_not_join() -> None:
    points = np.column_stack([np.arange(0, 1, 0.02), np.zeros((50, 2))])
    groups = (points[:, 0] > 0.49).astype(np.int64)
    np.testing.assert_array_equal(clusters_within(points, groups, 0.05) > 0, groups > 0)


def test_a_wide_box_gives_the_clusters_of_a_small_one() -> None:
    """One point far away makes the box too large for a table of all its voxels."""
    points = np.random.default_rng(1).uniform(0, 2, (600, 3))
    near = connected_clusters(points, 0.12)
    far = connected_clusters(np.vstack([points, [9000.0, -7000.0, 300.0]]), 0.12)
    shifted = connected_clusters(np.vstack([points - points.min(axis=0), [9e3, 7e3, 3e2]]), 0.12)
    assert far[-1] == far[:-1].max() + 1
    np.testing.assert_array_equal(shifted[:-1], near)
    assert 1 < len(partition(near)) < 600


def test_voxels_in_a_line_along_any_axis_have_places_of_their_own_in_the_table() -> None:
    """A hash that leaves out an axis sends all voxels along it to one place."""
    steps, table = np.array([1 << 42, 1 << 21, 1]), np.full(1 << 16, -1, dtype=np.int32)
    keys = np.empty(0, dtype=np.int64)
    for axis in range(3):
        line = 100 * steps[0] + 200 * steps[1] + 10 + np.arange(600) * steps[axis]
        assert len({_slot(key, keys, table, steps) for key in line}) > 580
