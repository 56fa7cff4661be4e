"""Convex pieces of a solid: of what is convex no more than its hull, of what is not, less."""

import numpy as np
import pytest
from executive_plugins.physics.convex_pieces import convex_pieces, is_convex
from executive_plugins.physics.even_directions import even_directions
from scipy.spatial import ConvexHull, Delaunay

from executive.arrays import Float, Int
from executive.geometry.hull_mesh import hull_mesh
from executive.messages.solid_stone import SolidStone


def ball(count: int = 400) -> tuple[Float, Int]:
    return hull_mesh(even_directions(count))


def volume_m3(pieces: list[Float]) -> float:
    """Return the volume that pieces cover together, by a grid of 6 cm."""
    axis = np.arange(-1.2, 1.21, 0.06)
    grid = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    covered = np.zeros(len(grid), dtype=bool)
    for piece in pieces:
        covered |= Delaunay(piece).find_simplex(grid) >= 0
    return float(covered.sum() * 0.06**3)


@pytest.mark.parametrize("count", [1, 2, 10, 200])
def test_directions_cover_the_sphere_evenly(count: int) -> None:
    found = even_directions(count)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0)
    np.testing.assert_allclose(found[:, 2], 1 - (2 * np.arange(count) + 1) / count)
    np.testing.assert_allclose(
        found.mean(axis=0), 0.0, atol=0.5 / count + 1e-12 if count > 2 else 1
    )


def test_one_piece_is_the_convex_hull() -> None:
    vertices, triangles = ball()
    inner = np.vstack([vertices, 0.3 * vertices])
    (piece,) = convex_pieces(inner, triangles, 1)
    assert len(piece) == len(vertices)
    assert ConvexHull(piece).volume == pytest.approx(ConvexHull(vertices).volume)


def test_pieces_of_a_ball_cover_it_and_nothing_else() -> None:
    vertices, triangles = ball()
    pieces = convex_pieces(vertices, triangles, 10)
    assert len(pieces) == 10
    for piece in pieces:
        assert np.linalg.norm(piece, axis=1).max() <= 1.0 + 1e-12
    whole = volume_m3([vertices])
    assert volume_m3(pieces) == pytest.approx(whole, rel=0.01)
    assert sum(ConvexHull(piece).volume for piece in pieces) > whole  # they overlap


def test_hollows_that_are_larger_than_a_patch_stay_hollow() -> None:
    """A ball with a belt that is drawn in by a third."""
    vertices, triangles = ball(1500)
    waist = 1 - np.exp(-((vertices[:, 2] / 0.25) ** 2)) / 3
    drawn_in = vertices * waist[:, None]
    hull, pieces = (convex_pieces(drawn_in, triangles, count) for count in (1, 200))
    solid = sum(abs(np.linalg.det(drawn_in[one])) / 6 for one in triangles)
    assert volume_m3(hull) > 1.08 * solid
    assert volume_m3(pieces) - solid < 0.5 * (volume_m3(hull) - solid)


def test_a_patch_through_the_centroid_bounds_no_volume() -> None:
    """Of a flat plate about its own middle there is no piece that has any: its hull is taken."""
    square = np.array(
        [[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 1e-3], [0, 0, -1e-3]]
    )
    triangles = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    pieces = convex_pieces(square, triangles, 3)
    assert pieces
    for piece in pieces:
        assert ConvexHull(piece).volume > 0


@pytest.mark.parametrize(("waist", "expected"), [(0.0, True), (0.1, False), (0.3, False)])
def test_a_ball_is_convex_until_its_belt_is_drawn_in(waist: float, expected: bool) -> None:
    vertices, triangles = ball()
    drawn_in = 1 - waist * np.exp(-((vertices[:, 2] / 0.25) ** 2))
    stone = SolidStone.of_mesh("ball", vertices * drawn_in[:, None], triangles, 2600.0)
    assert is_convex(stone.vertices, stone.volume_m3) is expected
