"""Checks of a path on ground that is known by a formula, with obstacles at known places."""

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.driving.check import PathCheck
from executive_plugins.driving.footprint import Footprint

from executive.arrays import Bool, Float
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.messages.drive import DriveTrouble

BASE_M = 1.2  # of the base frame above the ground
LIMIT_RAD = 0.3
# A machine of 4 m by 2 m whose body begins 0.4 m above the ground.
FOOT = Footprint(
    np.array([[-2.0, -1.0, 0.4 - BASE_M]]),
    np.array([[2.0, 1.0, 2.0]]),
    np.array([[x, y] for x in (-1.5, 0.5, 1.5) for y in (-0.8, 0.8)]),
)
LEVEL = pose(t=np.array([0.0, 0.0, BASE_M]))


class Ground:
    """A plane z = a x + b y + c, seen where x is less than a limit."""

    def __init__(
        self,
        plane: tuple[float, float, float] = (0.0, 0.0, 0.0),
        obstacles: Float | None = None,
        seen_to_x: float = np.inf,
        known: Callable[[Float], Bool] = lambda places: np.ones(len(places), dtype=bool),
    ) -> None:
        self._plane, self._seen_to_x, self._known = np.array(plane), seen_to_x, known
        self.obstacles_map = np.zeros((0, 3)) if obstacles is None else np.array(obstacles)
        self.asked: list[Float] = []

    def is_seen(self, places: Float) -> Bool:
        self.asked.append(places)
        return places[:, 0] < self._seen_to_x

    def heights(self, places: Float) -> Float:
        z = places @ self._plane[:2] + self._plane[2]
        return np.where(self._known(places), z, np.nan)


def check(
    ground: Ground,
    T_map_base: Float = LEVEL,
    driving: object = SimpleNamespace(max_slope_rad=LIMIT_RAD),
) -> PathCheck:
    machine = SimpleNamespace(driving=driving, stance=SimpleNamespace(base_height_m=BASE_M))
    return PathCheck(machine, FOOT, ground, T_map_base, least_seen=0.5)


def straight(length_m: float, step_m: float = 0.1, y: float = 0.0) -> Float:
    x = np.arange(round(length_m / step_m) + 1) * step_m
    return np.c_[x, np.full(len(x), y), np.zeros(len(x))]


def test_every_fourth_decimetre_and_the_end_are_checked() -> None:
    """The pose in which it stands is not."""
    ground = Ground()
    assert check(ground).trouble(straight(1.1)) is None
    middles = [places.mean(axis=0) - FOOT.supports.mean(axis=0) for places in ground.asked]
    assert np.array(middles) == pytest.approx(np.array([[0.4, 0], [0.8, 0], [1.1, 0]]))
    turning = Ground()
    check(turning).trouble(np.c_[np.ones(3), np.zeros(3), [0.0, 0.0, np.pi / 2]])
    (places,) = turning.asked  # a turn on the spot has its end alone
    expected = np.c_[1.0 - FOOT.supports[:, 1], FOOT.supports[:, 0]]
    assert places == pytest.approx(expected)
    coarse = Ground()
    check(coarse).trouble(straight(3.0, step_m=1.0))
    assert len(coarse.asked) == 4  # each, and the last one again


def test_ground_that_is_seen_too_little_is_refused_where_it_is() -> None:
    """Four of the six places are ahead: with two of them seen half of the ground is."""
    assert check(Ground(seen_to_x=1.0)).trouble(straight(0.4)) is None  # 4 of 6: 66 %
    assert check(Ground(seen_to_x=0.5)).trouble(straight(0.4)) == (
        DriveTrouble.UNSEEN,
        "33 % of the ground at (0.4, 0.0) is seen",
    )
    assert check(Ground(seen_to_x=1.7)).trouble(straight(3.2, y=-2.0)) == (
        DriveTrouble.UNSEEN,
        "33 % of the ground at (1.2, -2.0) is seen",
    )


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.0, -1.0), (0.6, 0.8)])
def test_ground_that_is_too_steep_is_refused_in_all_directions(way: tuple[float, float]) -> None:
    gentle, steep = np.tan(LIMIT_RAD - 0.005), np.tan(LIMIT_RAD + 0.02)
    assert check(Ground((gentle * way[0], gentle * way[1], 3.0))).trouble(straight(1.0)) is None
    assert check(Ground((steep * way[0], steep * way[1], 3.0))).trouble(straight(1.0)) == (
        DriveTrouble.TOO_STEEP,
        "the ground at (0.4, 0.0) slopes by 18° (17)",
    )


def test_a_machine_without_limits_stands_on_level_ground_alone() -> None:
    assert check(Ground(), driving=None).trouble(straight(1.0)) is None
    told = check(Ground((0.02, 0.0, 0.0)), driving=None).trouble(straight(1.0))
    assert told == (DriveTrouble.TOO_STEEP, "the ground at (0.4, 0.0) slopes by 1° (0)")


def test_ground_without_heights_continues_the_plane_that_the_machine_stands_on() -> None:
    """Three heights make no plane to stand on; four do."""
    tilted = about_axis(np.array([0.0, 1.0, 0.0]), -0.35)  # it looks uphill
    T = pose(tilted, tilted[:, 2] * BASE_M + [5.0, -3.0, 2.0])

    def first(count: int) -> Callable[[Float], Bool]:
        return lambda places: np.arange(len(places)) < count

    steep = check(Ground(known=first(3)), T).trouble(straight(0.4))
    assert steep == (DriveTrouble.TOO_STEEP, "the ground at (0.4, 0.0) slopes by 20° (17)")
    assert check(Ground(known=first(4)), T).trouble(straight(0.4)) is None
    # An obstacle 0.5 m above that plane is hit, 1 m above the level one at the same place.
    gentle = about_axis(np.array([0.0, 1.0, 0.0]), -0.2)
    T = pose(gentle, gentle[:, 2] * BASE_M + [5.0, -3.0, 2.0])
    plane_z = 2.0 + np.tan(0.2) * (1.4 - 5.0)
    for above_m, is_hit in ((0.35, False), (0.5, True), (3.0, True), (3.4, False)):
        obstacle = np.array([[1.4, 0.3, plane_z + above_m]])
        told = check(Ground(obstacles=obstacle, known=first(0)), T).trouble(straight(0.4))
        assert told == (
            (DriveTrouble.BLOCKED, "something stands in the way at (0.4, 0.0)") if is_hit else None
        )


@pytest.mark.parametrize(
    ("obstacle", "is_hit"),
    [
        ((2.35, 0.0, 1.0), True),
        ((2.45, 0.0, 1.0), False),
        ((0.4, 0.95, 1.0), True),
        ((0.4, 1.05, 1.0), False),
        ((0.4, 0.0, 0.35), False),
        ((0.4, 0.0, 0.45), True),
        ((0.4, 0.0, 3.15), True),
        ((0.4, 0.0, 3.25), False),
    ],
)
def test_what_is_in_the_machine_s_way_is_hit(obstacle: tuple[float, ...], is_hit: bool) -> None:
    told = check(Ground(obstacles=np.array([obstacle, [99.0, 0, 0]]))).trouble(straight(0.4))
    assert (told is not None) == is_hit


def test_the_body_turns_and_tilts_with_its_place() -> None:
    """At a yaw of 90° it is 4 m long in y; across a slope its roof leans downhill."""
    turned = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, np.pi / 2]])
    for obstacle, is_hit in (((1.0, 3.95, 1.0), True), ((2.05, 2.0, 1.0), False)):
        assert (check(Ground(obstacles=np.array([obstacle]))).trouble(turned) is not None) == is_hit
    slope = np.tan(0.25)
    across, up = (
        np.array([0.0, np.cos(0.25), np.sin(0.25)]),
        np.array([0.0, -np.sin(0.25), np.cos(0.25)]),
    )
    foot = np.array([1.0, 2.0, 2.0 * slope])
    ahead = np.array([[0.0, 2.0, 0.0], [1.0, 2.0, 0.0]])
    for aside_m, above_m, is_hit in (
        (0.95, 3.1, True),
        (-0.95, 3.1, True),
        (-1.05, 3.1, False),
        (1.05, 3.1, False),
        (0.0, 3.25, False),
        (0.0, 0.35, False),
        (0.95, 0.45, True),
    ):
        obstacle = foot + aside_m * across + above_m * up + [1.9, 0.0, 0.0]
        told = check(Ground((0.0, slope, 0.0), obstacles=obstacle[None])).trouble(ahead)
        assert (told is not None) == is_hit, (aside_m, above_m)
    # Uphill, its length is along the slope: 2 m ahead are less on the map.
    for along_m, is_hit in ((1.95, True), (2.05, False)):
        obstacle = along_m * np.array([np.cos(0.25), 0.0, np.sin(0.25)])
        obstacle = obstacle + [1.0, 2.0, slope] + [-np.sin(0.25), 0.0, np.cos(0.25)]
        told = check(Ground((slope, 0.0, 0.0), obstacles=obstacle[None])).trouble(ahead)
        assert (told is not None) == is_hit


def test_the_path_s_first_trouble_is_told() -> None:
    obstacles = np.array([[6.0, 0.0, 1.0], [6.01, 0.01, 1.01]])  # one voxel
    told = check(Ground(obstacles=obstacles, seen_to_x=9.0)).trouble(straight(12.0))
    assert told == (DriveTrouble.BLOCKED, "something stands in the way at (4.0, 0.0)")
