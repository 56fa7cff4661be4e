"""The load that stones bear at rest, by the statics of textbooks."""

import numpy as np
import pytest
from executive_plugins.physics.equilibrium import Touch, _pyramid, largest_load, least_load

from executive.arrays import Float

X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
UP = np.array([0.0, 0.0, 1.0])
HIGH_FRICTION = 1.9


def foot(
    half_x_m: float, half_y_m: float, z: float = 0.0, x: float = 0.0, below: int = -1, body: int = 0
) -> list[Touch]:
    """Return the corners of a level face on which a body stands."""
    return [
        Touch(below, body, np.array([x + sx * half_x_m, sy * half_y_m, z]), UP)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]


def load(touches: list[Touch], height_m: float, friction: float, towards: Float = X) -> float:
    """Return what one body bears whose centre is so high above the origin."""
    found = largest_load(touches, height_m * UP[None], np.array([700.0]), friction, towards)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("half_x_m", "half_y_m", "height_m", "towards"),
    [(0.3, 0.5, 0.4, X), (0.3, 0.5, 0.4, -X), (0.3, 0.5, 0.4, Y), (0.2, 0.2, 0.8, -Y)],
)
def test_a_block_tips_about_its_edge(
    half_x_m: float, half_y_m: float, height_m: float, towards: Float
) -> None:
    """At half its width over the height of its centre, if it does not slide before."""
    half_m = half_x_m if abs(towards[0]) else half_y_m
    found = load(foot(half_x_m, half_y_m), height_m, HIGH_FRICTION, towards)
    assert found == pytest.approx(half_m / height_m)


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.6])
def test_a_low_block_slides(friction: float) -> None:
    """Along an edge of the pyramid it has all the friction, between two cos 22.5° of it."""
    touches = foot(1.0, 1.0)
    assert load(touches, 0.1, friction, X) == pytest.approx(friction)
    between = np.array([np.cos(np.pi / 8), np.sin(np.pi / 8), 0.0])
    assert load(touches, 0.1, friction, between) == pytest.approx(friction * np.cos(np.pi / 8))


def test_no_load_is_told_beyond_twice_the_weight() -> None:
    assert load(foot(5.0, 5.0), 0.1, 9.0) == 2.0


def test_a_centre_beside_the_middle_tips_earlier_to_that_side() -> None:
    touches = foot(0.3, 0.3)
    centre, mass = np.array([[0.1, 0.0, 0.5]]), np.array([1.0])
    ahead = largest_load(touches, centre, mass, HIGH_FRICTION, X)
    back = largest_load(touches, centre, mass, HIGH_FRICTION, -X)
    assert ahead == pytest.approx(0.2 / 0.5)
    assert back == pytest.approx(0.4 / 0.5)


@pytest.mark.parametrize("x", [0.31, -0.31])
def test_a_centre_beyond_the_foot_falls_unless_the_load_holds_it(x: float) -> None:
    """A load in the other direction does, so that all directions have to be asked for."""
    centre, outward = np.array([[x, 0.0, 0.5]]), np.sign(x) * X
    assert largest_load(foot(0.3, 0.3), centre, np.ones(1), HIGH_FRICTION, outward) is None
    assert largest_load(foot(0.3, 0.3), centre, np.ones(1), HIGH_FRICTION, Y) is None
    back = largest_load(foot(0.3, 0.3), centre, np.ones(1), HIGH_FRICTION, -outward)
    assert back == pytest.approx(0.61 / 0.5)


def test_the_least_load_is_that_of_the_worst_direction() -> None:
    touches, mass = foot(0.3, 0.3), np.ones(1)
    centre = np.array([[0.1, 0.0, 0.5]])
    assert least_load(touches, centre, mass, HIGH_FRICTION, np.array([-X, X, Y])) == pytest.approx(
        largest_load(touches, centre, mass, HIGH_FRICTION, X)
    )
    beyond = np.array([[0.31, 0.0, 0.5]])  # one direction would hold it
    assert least_load(touches, beyond, mass, HIGH_FRICTION, np.array([-X, X])) is None
    assert least_load([], centre, mass, HIGH_FRICTION, np.array([X])) is None


def test_what_touches_nothing_bears_nothing() -> None:
    assert largest_load([], np.zeros((1, 3)), np.ones(1), 0.5, X) is None
    beside = [*foot(0.3, 0.3, x=5.0)]
    assert largest_load(beside, UP[None], np.ones(1), 0.5, X) is None


@pytest.mark.parametrize("slope_rad", [0.1, 0.3])
def test_on_a_slope_the_rest_of_the_friction_angle_is_left(slope_rad: float) -> None:
    """The resultant of weight and load leans by the angle of friction from the normal at most."""
    friction = 0.5
    normal = np.array([-np.sin(slope_rad), 0.0, np.cos(slope_rad)])
    along = np.array([np.cos(slope_rad), 0.0, np.sin(slope_rad)])
    corners = [sx * along + sy * Y for sx in (-2, 2) for sy in (-2, 2)]
    touches = [Touch(-1, 0, corner, normal) for corner in corners]
    centre, mass = 0.01 * normal[None], np.array([3.0])
    cone = _pyramid(normal, friction)
    downhill, uphill = (largest_load(touches, centre, mass, friction, d) for d in (-X, X))
    # The section of the pyramid along the slope.
    leaning = [float((edge @ along) / (edge @ normal)) for edge in cone]
    most_rad = np.arctan(max(leaning))
    assert downhill == pytest.approx(np.tan(most_rad - slope_rad))
    assert uphill == pytest.approx(np.tan(most_rad + slope_rad))


@pytest.mark.parametrize(("upper_kg", "lower_kg"), [(300.0, 800.0), (800.0, 300.0), (1.0, 1.0)])
def test_a_tower_tips_as_one_or_at_its_joint_whichever_is_first(
    upper_kg: float, lower_kg: float
) -> None:
    """Two blocks of equal height 2 h on one another, the upper one narrower."""
    h, half_m = 0.25, (0.4, 0.1)
    touches = [*foot(half_m[0], 0.5), *foot(half_m[1], 0.5, z=2 * h, below=0, body=1)]
    centres, masses = np.array([[0, 0, h], [0, 0, 3 * h]]), np.array([lower_kg, upper_kg])
    whole = half_m[0] * masses.sum() / (masses @ centres[:, 2])
    found = largest_load(touches, centres, masses, HIGH_FRICTION, X)
    assert found == pytest.approx(min(whole, half_m[1] / h))


def test_a_stone_between_two_walls_is_held_by_friction_alone() -> None:
    """Two walls press as hard as they like: it hangs where there is friction, and else it falls."""
    touches = [Touch(-1, 0, np.array([-0.5, y, 0.0]), X) for y in (-0.2, 0.2)] + [
        Touch(-1, 0, np.array([0.5, y, 0.0]), -X) for y in (-0.2, 0.2)
    ]
    assert largest_load(touches, np.zeros((1, 3)), np.ones(1), 0.5, X) == 2.0
    assert largest_load(touches, np.zeros((1, 3)), np.ones(1), 0.0, X) is None


@pytest.mark.parametrize(
    "normal", [UP, X, -Y, np.array([0.6, 0.0, 0.8]), np.array([0.0, 0.6, 0.8])]
)
def test_the_edges_of_a_pyramid_lean_by_the_friction_all_around(normal: Float) -> None:
    edges = _pyramid(normal, 0.4)
    np.testing.assert_allclose(edges @ normal, 1.0)
    across = edges - normal
    np.testing.assert_allclose(np.linalg.norm(across, axis=1), 0.4)
    np.testing.assert_allclose(across.sum(axis=0), 0.0, atol=1e-12)
    steps = (across * np.roll(across, 1, axis=0)).sum(axis=1)
    np.testing.assert_allclose(steps, 0.16 * np.cos(np.pi / 4))
