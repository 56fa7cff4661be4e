"""Which segment is which known stone: by distance, and by the ratio of the sizes."""

import numpy as np
import pytest
from executive_plugins.objects.association import (
    Reach,
    associate,
    associate_known_first,
    carried_m,
    newest_pose,
    owner_of_piece,
)

from executive.geometry.pose import pose
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent

CUBE = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3) / 3**0.5  # diagonal 1 m
LARGE_M = 2.0  # diagonal of the stone
MAX_RATIO = 2.0


def associated(diagonal_m: float, distance_m: float) -> bool:
    """Return whether a segment of a size at a distance is taken for the large stone."""
    model = LARGE_M * CUBE
    stone = Stone(1, StoneState.ON_GROUND, model, np.zeros(3), np.eye(4), True)
    points = diagonal_m * CUBE + [distance_m, 0.0, 0.0]
    segment = Segment(0, points, points.mean(axis=0), np.ones(3))
    return associate([segment], [stone], [Reach(5.0)], MAX_RATIO) == [0]


@pytest.mark.parametrize(
    ("diagonal_m", "distance_m", "expected"),
    [
        (0.4, 0.8, True),  # a part of the stone, within half of its diagonal
        (0.4, 1.2, False),  # a pebble beyond it is not the stone that fell
        (1.2, 1.2, True),  # a stone of about its size is
        (3.9, 0.1, True),
        (4.0, 0.0, True),  # the largest ratio itself
        (4.1, 0.1, False),  # two merged stones are not one stone that has grown
        (2.0, 4.9, True),
        (2.0, 5.1, False),  # beyond the reach of the search
    ],
)
def test_size_and_distance_decide_together(
    diagonal_m: float, distance_m: float, expected: bool
) -> None:
    assert associated(diagonal_m, distance_m) is expected


def at(diagonal_m: float, x_m: float) -> Segment:
    points = diagonal_m * CUBE + [x_m, 0.0, 0.0]
    return Segment(0, points, points.mean(axis=0), np.ones(3))


def test_a_stone_that_may_have_rolled_is_what_has_its_size_and_not_what_is_nearest() -> None:
    stone = Stone(1, StoneState.PLACED, LARGE_M * CUBE, np.zeros(3), np.eye(4), True)
    parts = [at(0.8, 0.3), at(1.8, 0.9), at(1.0, 0.5)]
    assert associate(parts, [stone], [Reach(3.0, may_have_rolled=True)], MAX_RATIO) == [-1, 0, -1]
    # One that was left where it lay is seen in part there.
    assert associate(parts, [stone], [Reach(3.0)], MAX_RATIO) == [0, -1, -1]
    # Of small parts alone, the larger one: it is 0.26 of the stone's size nearer to its own.
    rest = [parts[0], parts[2]]
    assert associate(rest, [stone], [Reach(3.0, may_have_rolled=True)], MAX_RATIO) == [-1, 0]


def test_distance_decides_between_two_of_a_size_and_a_part_at_the_place_beats_a_far_stone() -> None:
    stone = Stone(1, StoneState.LOST, LARGE_M * CUBE, np.zeros(3), np.eye(4), True)
    rolled = [Reach(5.0, may_have_rolled=True)]
    assert associate([at(2.0, 2.1), at(2.0, 1.9)], [stone], rolled, MAX_RATIO) == [-1, 0]
    # A part of half its size costs as much as a way of its size.
    assert associate([at(1.0, 0.0), at(2.0, 2.1)], [stone], rolled, MAX_RATIO) == [0, -1]
    assert associate([at(1.0, 0.0), at(2.0, 1.9)], [stone], rolled, MAX_RATIO) == [-1, 0]


LYING = Stone(1, StoneState.PLACED, LARGE_M * CUBE, np.zeros(3), np.eye(4), True)
FALLEN = Stone(
    2, StoneState.LOST, LARGE_M * CUBE + [1, 0, 0], np.array([1.0, 0, 0]), np.eye(4), True
)
REACHES = [Reach(0.6), Reach(3.0, may_have_rolled=True)]


@pytest.mark.parametrize(("agrees", "expected"), [(True, [0, 1]), (False, [1, 0])])
def test_a_stone_that_fell_onto_another_may_lie_where_that_one_was(
    agrees: bool, expected: list[int]
) -> None:
    """The one that lay at 0 is pushed to −0.7 m by one that was lost at 1 m and is now at 0.55."""
    segments = [at(LARGE_M, 0.55), at(LARGE_M, -0.7)]
    asked = []

    def has_its_surface(stone: Stone, segment: Segment) -> bool:
        asked.append((stone.id, round(float(segment.centroid[0]), 2)))
        return agrees

    found = associate_known_first(
        segments, [LYING, FALLEN], REACHES, MAX_RATIO, has_its_surface, Reach(3.0, True)
    )
    assert found == expected
    assert asked == [(1, 0.55)]


def test_without_a_lost_stone_no_surface_is_compared() -> None:
    found = associate_known_first(
        [at(LARGE_M, 0.55)], [LYING], REACHES[:1], MAX_RATIO, pytest.fail, Reach(3.0, True)
    )
    assert found == [0]


def test_a_stone_that_shows_another_surface_is_still_the_nearest_if_nothing_else_is() -> None:
    found = associate_known_first(
        [at(LARGE_M, 0.1), at(LARGE_M, 1.1)],
        [LYING, FALLEN],
        REACHES,
        MAX_RATIO,
        lambda stone, segment: False,
        Reach(3.0, True),
    )
    assert found == [0, 1]


def test_no_segment_or_no_stone_is_no_pair() -> None:
    assert associate([], [], [], MAX_RATIO) == []
    segment = Segment(0, CUBE, np.zeros(3), np.ones(3))
    assert associate([segment], [], [], MAX_RATIO) == [-1]


def test_a_piece_tells_nothing_of_where_a_stone_is() -> None:
    """It was released 3 m from its grasp, and has not been seen since."""
    kinds = {"found": 0.0, "grasp": 0.0, "release": 3.0, "piece": 3.0, "state": 3.0}
    history = [
        StoneEvent(0.0, kind, StoneState.ON_GROUND, pose(t=np.array([x_m, 0.0, 0.0])))
        for kind, x_m in kinds.items()
    ]
    assert newest_pose(history).kind == "release"
    assert carried_m(history) == 3.0


@pytest.mark.parametrize(("outside_m", "owner"), [(0.07, 7), (0.09, None)])
def test_a_piece_lies_in_the_hull_of_its_stone_but_for_the_errors_of_the_map(
    outside_m: float, owner: int | None
) -> None:
    model = LARGE_M * CUBE
    top_m = model[:, 2].max()
    points = np.array([[0.0, 0.0, top_m + outside_m], [0.1, 0.0, top_m + outside_m]])
    stones = [
        Stone(
            number, StoneState.ON_GROUND, model + [away_m, 0.0, 0.0], np.zeros(3), np.eye(4), True
        )
        for number, away_m in ((3, 5.0), (7, 0.0))
    ]
    found = owner_of_piece(Segment(0, points, points[0], np.ones(3)), stones, 0.08)
    assert (None if found is None else found.id) == owner


def test_a_flat_model_holds_no_piece() -> None:
    flat = CUBE * [1.0, 1.0, 0.0]
    stone = Stone(1, StoneState.ON_GROUND, flat, np.zeros(3), np.eye(4), True)
    assert owner_of_piece(Segment(0, flat, flat[0], np.ones(3)), [stone], 0.08) is None


@pytest.mark.parametrize(
    ("kinds", "carried"),
    [
        ([], 0.0),
        (["release"], 0.0),  # from nowhere that is known
        (["found", "grasp"], 0.0),
        (["found", "grasp", "release"], 1.0),
        (["found", "grasp", "state", "release", "state"], 2.0),  # states have no pose of their own
        (["found", "grasp", "release", "seen"], 0.0),
    ],
)
def test_only_a_stone_that_was_released_last_may_have_fallen_on_the_way(
    kinds: list[str], carried: float
) -> None:
    history = [
        StoneEvent(0.0, kind, StoneState.ON_GROUND, pose(t=np.array([float(x_m), 0.0, 0.0])))
        for x_m, kind in enumerate(kinds)
    ]
    assert carried_m(history) == carried


@pytest.mark.parametrize(("sizes_away", "expected"), [(9.5, [-1, 0]), (10.4, [0, -1])])
def test_a_segment_of_one_point_is_a_thousandth_of_any_stone(
    sizes_away: float, expected: list[int]
) -> None:
    """With a largest ratio of 2, that costs as much as a way of ln 1000 / ln 2 = 9.97 sizes."""
    stone = Stone(1, StoneState.LOST, LARGE_M * CUBE, np.zeros(3), np.eye(4), True)
    point = Segment(0, np.zeros((1, 3)), np.zeros(3), np.zeros(3))
    seen = [point, at(LARGE_M, sizes_away * LARGE_M)]
    rolled = [Reach(50.0, may_have_rolled=True)]
    assert associate(seen, [stone], rolled, MAX_RATIO) == expected
