"""Places of a map in which something moves."""

import numpy as np
import pytest

from executive.errors import ShapeError
from executive.messages.moving_places import MovingPlaces

PLACES = MovingPlaces(0.5, np.array([[0, 0, 0], [-3, 2, 1]]))


def test_points_are_told_by_the_cube_that_they_are_in() -> None:
    points = np.array(
        [[0.1, 0.49, 0.2], [-0.1, 0.1, 0.1], [-1.3, 1.2, 0.7], [-1.3, 1.2, 1.01], [0.6, 0.1, 0.1]]
    )
    assert PLACES.hold(points).tolist() == [True, False, True, False, False]
    assert PLACES.share(points) == pytest.approx(0.4)


def test_without_points_or_places_nothing_moves() -> None:
    assert PLACES.share(np.empty((0, 3))) == 0.0
    assert MovingPlaces(0.5, np.empty((0, 3))).share(np.zeros((5, 3))) == 0.0


def test_cubes_of_another_shape_are_refused() -> None:
    with pytest.raises(ShapeError, match="cells has shape"):
        MovingPlaces(0.5, np.zeros((2, 2), dtype=np.int64))
    assert not PLACES.cells.flags.writeable
