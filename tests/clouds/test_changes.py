"""What stands in one cloud only, by what the other one shows."""

import numpy as np
import pytest

from executive.clouds.changes import HeightMap, Standing, check_overlap, verdicts
from executive.errors import DataError

NOISE_M = 0.06


def ground(seed: int, slope: float = 0.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-3, 3, (40_000, 2))
    return np.column_stack([xy, slope * xy[:, 0] + rng.normal(0, 0.01, len(xy))])


def dome(seed: int, x: float, y: float, slope: float = 0.0) -> np.ndarray:
    """Half a ball of 0.4 m on the ground."""
    rng = np.random.default_rng(seed)
    d = rng.normal(size=(6000, 3))
    d = 0.4 * np.abs(d / np.linalg.norm(d, axis=1)[:, None]) * np.sign(d * [1, 1, 0] + [0, 0, 1])
    return np.asarray(d + [x, y, slope * x])


def beside(points: np.ndarray, x: float, y: float) -> np.ndarray:
    """Leave out the ground under a dome."""
    return points[np.hypot(points[:, 0] - x, points[:, 1] - y) > 0.4]


@pytest.mark.parametrize("slope", [0.0, 0.2])
def test_what_stays_stays_and_what_left_is_absent(slope: float) -> None:
    things = [dome(1, -1.0, 0.0, slope), dome(2, 1.0, 1.0, slope)]
    later = np.vstack([beside(ground(3, slope), -1.0, 0.0), dome(4, -1.0, 0.0, slope)])
    stayed, left = verdicts(things, HeightMap(later), NOISE_M)
    assert (stayed.standing, left.standing) == (Standing.STAYED, Standing.ABSENT)
    assert left.lower > 0.95
    assert stayed.lower < 0.1


def test_what_the_other_cloud_does_not_show_is_unseen() -> None:
    (hidden,) = verdicts([dome(1, 1.0, 1.0)], HeightMap(beside(ground(2), 1.0, 1.0)), NOISE_M)
    assert hidden.standing is Standing.UNSEEN
    (far,) = verdicts([dome(1, 9.0, 9.0)], HeightMap(ground(2)), NOISE_M)
    assert far == type(far)(Standing.UNSEEN, 0.0, 0.0)


def test_what_is_no_higher_than_the_noise_says_nothing() -> None:
    flat = dome(1, 0.0, 0.0) * [1, 1, 0.2]
    assert verdicts([flat], HeightMap(ground(2)), NOISE_M)[0].standing is Standing.UNSEEN


def test_one_that_was_put_on_another_is_told_by_the_upper_one() -> None:
    low, high = dome(1, 0.0, 0.0), dome(2, 0.0, 0.0) + [0.0, 0.0, 0.35]
    both = np.vstack([beside(ground(3), 0.0, 0.0), low, high])
    assert verdicts([low], HeightMap(both), NOISE_M)[0].standing is Standing.STAYED
    alone = np.vstack([beside(ground(3), 0.0, 0.0), low])
    assert verdicts([high], HeightMap(alone), NOISE_M)[0].standing is Standing.ABSENT


def test_clouds_of_two_places_are_refused_with_the_cure() -> None:
    check_overlap(ground(1), ground(2) + [4.0, 0.0, 0.0])
    with pytest.raises(DataError, match=r"share 0 of 36 square metres.*--guess"):
        check_overlap(ground(1), ground(2) + [40.0, 0.0, 0.0])
    with pytest.raises(DataError, match="without points"):
        HeightMap(np.empty((0, 3)))
