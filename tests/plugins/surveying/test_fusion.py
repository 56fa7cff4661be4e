"""Points of many pictures merged on a grid."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from executive_plugins.surveying import fusion
from executive_plugins.surveying.fusion import cells_of, fuse
from numpy.typing import NDArray

HIGH = np.array([0.0, 0.0, 50.0])


def pictures(count: int, each: int) -> list[Callable[[], NDArray[np.void]]]:
    """Return cells of pictures that show other cells but for the first, at different heights."""
    parts = []
    for k in range(count):
        x = np.concatenate([[0.5], 1.5 + k * each + np.arange(each - 1)])
        points = np.column_stack([x, np.full(each, 0.5), np.full(each, 0.01 * k)])
        parts.append(partial(cells_of, points, HIGH, 1.0))
    return parts


@pytest.mark.parametrize("count", [1, 2, 3, 7, 8])
def test_a_cell_is_the_mean_of_its_points_from_all_pictures(count: int) -> None:
    points, normals = fuse(pictures(count, 5), 1)
    assert len(points) == 1 + 4 * count
    first = points[np.argmin(points[:, 0])]
    np.testing.assert_allclose(first, [0.5, 0.5, 0.01 * (count - 1) / 2], atol=1e-12)
    assert (np.diff(points[:, 0]) > 0).all()  # in the order of the cells
    assert normals.shape == points.shape


def test_parts_of_the_site_that_are_merged_one_by_one_make_the_same_cloud(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    merged, added = [], fusion._added
    parts = [partial(np.copy, part()) for part in pictures(16, 500)]

    def counted(keys: NDArray[np.int64], columns: NDArray[np.float64]) -> NDArray[np.void]:
        merged.append(len(keys))
        return added(keys, columns)

    monkeypatch.setattr(fusion, "_added", counted)
    one, several = fuse(parts, 1), fuse(parts, 1, most=2000)
    np.testing.assert_array_equal(one[0], several[0])
    np.testing.assert_array_equal(one[1], several[1])
    assert merged[0] == 16 * 500 == sum(merged[1:])  # each row once
    assert 4 <= len(merged[1:]) <= 6
    assert max(merged[1:]) <= 2100


def test_cells_of_few_points_are_dropped_and_no_picture_is_no_cloud() -> None:
    points, _ = fuse(pictures(3, 5), 3)
    np.testing.assert_allclose(points, [[0.5, 0.5, 0.01]])
    assert len(fuse([], 1)[0]) == 0
