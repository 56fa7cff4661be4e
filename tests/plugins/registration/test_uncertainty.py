"""How surely a motion is known, and that too little overlap says nothing."""

import numpy as np
import pytest
from executive_plugins.registration.similarity import Similarity, Surface
from executive_plugins.registration.uncertainty import motion_uncertainty

from executive.arrays import Float

REACH_M, BEND_M = 0.3, 1e-6
UNMOVED = Similarity(np.eye(4), 1.0)
AXIS = np.arange(-3.0, 3.0, 0.1)
FLOOR = np.append(np.stack(np.meshgrid(AXIS, AXIS), axis=-1).reshape(-1, 2), np.zeros((3600, 1)), 1)
WALL = np.column_stack([np.full(3600, 3.2), FLOOR[:, 0], FLOOR[:, 1] + 3.2])
OTHER = np.column_stack([FLOOR[:, 0], np.full(3600, 3.2), FLOOR[:, 1] + 3.2])


def surface(*planes: tuple[Float, list[float]]) -> Surface:
    points = np.vstack([plane for plane, _ in planes])
    normals = np.vstack([np.tile(normal, (len(plane), 1)) for plane, normal in planes])
    return Surface(points, normals.astype(float))


# Three planes alone meet in a corner, about which any scale would do.
FOURTH = WALL * [-1.0, 1.0, 1.0]
ROOM = surface((FLOOR, [0, 0, 1]), (WALL, [1, 0, 0]), (OTHER, [0, 1, 0]), (FOURTH, [1, 0, 0]))
ALL = np.vstack([FLOOR, WALL, OTHER, FOURTH])


def rough(points: Float, std_m: float, seed: int = 0) -> Float:
    """Return points of which each cubic metre as a whole is off by some noise along each axis."""
    rng = np.random.default_rng(seed)
    cells, rows = np.unique(np.floor(points).astype(int), axis=0, return_inverse=True)
    return np.asarray(points + rng.normal(0.0, std_m, (len(cells), 3))[rows])


def test_with_walls_all_is_known_and_twice_the_noise_is_twice_the_deviation() -> None:
    one, two = (
        motion_uncertainty(ROOM, rough(ALL, std_m), UNMOVED, REACH_M, BEND_M)
        for std_m in (0.01, 0.02)
    )
    assert one is not None
    assert two is not None
    np.testing.assert_allclose(one.centre, ALL.mean(axis=0), atol=0.05)
    np.testing.assert_allclose(one.covariance, one.covariance.T)
    shifts = np.sqrt(np.diag(one.covariance)[3:])
    # Each wall and the floor have 36 square metres of independent errors of 1 cm, of which four
    # unknowns that they share take their part.
    assert (shifts > 0.01 / np.sqrt(144)).all()
    assert (shifts < 0.01).all()
    ratio = np.sqrt(np.diag(two.covariance) / np.diag(one.covariance))
    np.testing.assert_allclose(ratio, 2.0, rtol=0.1)


def test_on_a_floor_alone_height_and_tilt_are_known_and_nothing_else() -> None:
    floor = surface((FLOOR, [0, 0, 1]))
    found = motion_uncertainty(floor, rough(FLOOR, 0.01), UNMOVED, REACH_M, BEND_M)
    assert found is not None
    std = np.sqrt(np.diag(found.covariance))
    assert std[5] < 0.01
    assert std[:2].max() < 0.01
    # What no residual tells has no spread in this estimate either; bends alone remain.
    assert std[3:5].max() < 1e-3


def test_bends_of_the_source_are_added_as_a_tilt_over_its_radius_and_as_a_shift() -> None:
    source = rough(ALL, 0.01)
    stiff, bent = (
        motion_uncertainty(ROOM, source, UNMOVED, REACH_M, bend_m) for bend_m in (0.0, 0.1)
    )
    assert stiff is not None
    assert bent is not None
    added = np.diag(bent.covariance - stiff.covariance)
    radius_m = np.sqrt(((source - source.mean(axis=0)) ** 2).sum(axis=1).mean())
    np.testing.assert_allclose(added[3:], 0.1**2, rtol=1e-6)
    np.testing.assert_allclose(added[:3], (0.1 / radius_m) ** 2, rtol=0.02)


def test_a_motion_is_applied_before_the_surfaces_are_compared() -> None:
    away = np.eye(4)
    away[:3, 3] = [5.0, -2.0, 1.0]
    source = rough(ALL, 0.01)
    there = (source - away[:3, 3]) / 1.02
    moved = motion_uncertainty(ROOM, there, Similarity(away, 1.02), REACH_M, BEND_M)
    unmoved = motion_uncertainty(ROOM, source, UNMOVED, REACH_M, BEND_M)
    assert moved is not None
    assert unmoved is not None
    np.testing.assert_allclose(moved.covariance, unmoved.covariance, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(moved.centre, unmoved.centre, atol=1e-9)


@pytest.mark.parametrize(("metres", "is_enough"), [(7, False), (8, True)])
def test_fewer_square_metres_than_unknowns_say_nothing(metres: int, is_enough: bool) -> None:
    """Seven unknowns: rotation, shift and scale."""
    along, across = np.meshgrid(np.arange(0.05, metres, 0.1) - 4.0, np.arange(0.05, 1.0, 0.1))
    strip = np.column_stack([along.ravel(), across.ravel(), np.full(along.size, 0.05)])
    floor = surface((strip, [0, 0, 1]))
    found = motion_uncertainty(floor, strip + [0.0, 0.0, 0.01], UNMOVED, REACH_M, BEND_M)
    assert (found is not None) is is_enough


def test_what_is_beyond_the_reach_does_not_overlap() -> None:
    far = rough(ALL, 0.01) + [0.0, 0.0, 20.0]
    assert motion_uncertainty(ROOM, far, UNMOVED, REACH_M, BEND_M) is None
