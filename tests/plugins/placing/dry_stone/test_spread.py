"""Points that are apart, first come."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.spread import spread


@pytest.mark.parametrize(
    ("most", "chosen"), [(1, [0]), (2, [0, 2]), (3, [0, 2, 4]), (9, [0, 2, 4])]
)
def test_a_point_near_a_chosen_one_is_passed_over(most: int, chosen: list[int]) -> None:
    x = [0.0, 0.2, 0.3, 0.25, -1.0, 0.5]  # 0.5 is 0.2 from the second that is chosen
    points = np.column_stack([x, np.zeros(6), np.zeros(6)])
    assert spread(points, most, 0.25).tolist() == chosen


def test_a_distance_counts_along_all_axes() -> None:
    points = np.array([[0.0, 0.0, 0.0], [0.2, 0.2, 0.0], [0.0, 0.0, 0.3]])
    assert spread(points, 3, 0.25).tolist() == [0, 1, 2]
    assert spread(points, 3, 0.29).tolist() == [0, 2]


def test_a_turn_counts_as_an_axis_of_its_own() -> None:
    """Two places at one point are apart if the stone is turned by enough."""
    points = np.zeros((3, 4))
    points[:, 3] = (0.0, 0.1, 0.3)
    assert spread(points, 3, 0.25).tolist() == [0, 2]


def test_no_points_give_none() -> None:
    assert spread(np.empty((0, 3)), 5, 0.25).tolist() == []
