"""Points of many pictures merged on a grid."""

import numpy as np
import pytest
from executive_plugins.surveying import fusion

from executive.arrays import Float, Int

HIGH = np.array([0.0, 0.0, 50.0])


def pictures(count: int, each: int) -> list[tuple[Float, Float]]:
    """Return points of pictures that show other cells but for the first, at different heights."""
    parts = []
    for k in range(count):
        x = np.concatenate([[0.5], 1.5 + k * each + np.arange(each - 1)])
        parts.append((np.column_stack([x, np.full(each, 0.5), np.full(each, 0.01 * k)]), HIGH))
    return parts


@pytest.mark.parametrize("count", [1, 2, 3, 7, 8])
def test_a_cell_is_the_mean_of_its_points_from_all_pictures(count: int) -> None:
    points, normals = fusion.fuse(pictures(count, 5), 1.0, 1)
    assert len(points) == 1 + 4 * count
    first = points[np.argmin(points[:, 0])]
    np.testing.assert_allclose(first, [0.5, 0.5, 0.01 * (count - 1) / 2], atol=1e-12)
    assert (np.diff(points[:, 0]) > 0).all()  # in the order of the cells
    assert normals.shape == points.shape


def test_cells_are_sorted_anew_a_few_times_and_not_once_for_each_picture(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sorted_rows, added = [0], fusion._added

    def counted(keys: Int, rows: Float) -> tuple[Int, Float]:
        sorted_rows[0] += len(keys)
        return added(keys, rows)

    monkeypatch.setattr(fusion, "_added", counted)
    count, each = 64, 100
    fusion.fuse(pictures(count, each), 1.0, 1)
    assert sorted_rows[0] <= count * each * (np.log2(count) + 2)


def test_cells_of_few_points_are_dropped_and_no_picture_is_no_cloud() -> None:
    points, _ = fusion.fuse(pictures(3, 5), 1.0, 3)
    np.testing.assert_allclose(points, [[0.5, 0.5, 0.01]])
    assert len(fusion.fuse([], 1.0, 1)[0]) == 0
