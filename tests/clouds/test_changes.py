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


def squares(*metres: tuple[int, int]) -> np.ndarray:
    """Return a point in each of some square metres."""
    return np.array([[x + 0.5, y + 0.5, 0.0] for x, y in metres])


@pytest.mark.parametrize(
    ("earlier", "later", "told"),
    [
        ([(0, 0)], [(0, 0)], ""),  # one square metre is a whole site here
        ([(0, 0)], [(0, 1)], "share 0 of 1 square metres"),
        ([(i, 0) for i in range(20)], [(i, 0) for i in range(18, 38)], ""),
        ([(i, 0) for i in range(20)], [(i, 0) for i in range(19, 39)], "share 1 of 20 square"),
        ([(i, 0) for i in range(10)], [(i, 0) for i in range(9, 99)], ""),  # of the smaller one
    ],
)
def test_a_tenth_of_the_smaller_site_has_to_be_in_both(
    earlier: list[tuple[int, int]], later: list[tuple[int, int]], told: str
) -> None:
    one, other = squares(*earlier), squares(*later)
    for pair in ((one, other), (other, one)):
        if told:
            with pytest.raises(DataError, match=told):
                check_overlap(*pair)
        else:
            check_overlap(*pair)


def column(x: float, heights: tuple[float, ...]) -> np.ndarray:
    """Return points above one another in the square of 10 cm at x."""
    return np.array([[x + 0.05, 0.05, height] for height in heights])


def test_a_map_holds_the_highest_point_of_each_square_and_knows_its_ends() -> None:
    seen = HeightMap(np.vstack([column(0.0, (0.1, 0.7, 0.3)), column(0.2, (-0.4,))]))
    places = np.array([[0.01, 0.01], [0.09, 0.09], [0.15, 0.05], [0.25, 0.05], [-0.01, 0.05],
                       [0.05, 0.11], [0.31, 0.05]])  # fmt: skip
    inf = -np.inf
    np.testing.assert_array_equal(seen.at(places), [0.7, 0.7, inf, -0.4, inf, inf, inf])
    np.testing.assert_array_equal(seen.shows(places), np.isfinite(seen.at(places)))
    with pytest.raises(DataError, match="a cloud without points shows no site"):
        HeightMap(np.empty((0, 3)))


def verdict_of(thing: list[float], other: list[float | None]) -> tuple[Standing, float, float]:
    """Return the verdict on a thing by its heights in a row of squares, above a foot at 0."""
    points = np.vstack([column(0.1 * i, (0.0, top)) for i, top in enumerate(thing)])
    seen = [column(0.1 * i, (top,)) for i, top in enumerate(other) if top is not None]
    (found,) = verdicts([points], HeightMap(np.vstack(seen)), NOISE_M)
    return found.standing, found.seen, found.lower


def test_a_thing_is_absent_where_most_of_what_is_seen_lies_below_its_middle() -> None:
    absent, stayed = Standing.ABSENT, Standing.STAYED
    assert verdict_of([1.0] * 4, [0.49] * 3 + [0.51]) == (absent, 1.0, 0.75)
    assert verdict_of([1.0] * 4, [0.49] * 2 + [0.51] * 2) == (stayed, 1.0, 0.5)
    assert verdict_of([1.0] * 4, [0.0, 0.0, None, None]) == (absent, 0.5, 1.0)
    assert verdict_of([1.0] * 4, [0.0, None, None, None]) == (Standing.UNSEEN, 0.25, 0.0)


def test_squares_at_the_foot_do_not_speak() -> None:
    low, high = 1.99 * NOISE_M, 2.01 * NOISE_M
    assert verdict_of([1.0, low], [1.0, 0.0]) == (Standing.STAYED, 1.0, 0.0)
    assert verdict_of([1.0, high], [1.0, 0.0]) == (Standing.STAYED, 1.0, 0.5)
