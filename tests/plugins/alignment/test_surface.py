"""The nearest points of a thinned surface, and the planes through their neighbours."""

import numpy as np
import pytest
from executive_plugins.alignment.surface import Surface
from executive_plugins.alignment.tangent_planes import NO_PLANE, tangent_planes


def test_the_nearest_of_a_thinned_surface_are_found_near_and_far() -> None:
    rng = np.random.default_rng(0)
    points, queries = rng.uniform(-1, 1, (500, 3)), rng.uniform(-4, 4, (300, 3))
    apart = np.linalg.norm(queries[:, None] - points, axis=2)
    assert np.array_equal(Surface(points, 0.05, 12).nearest(queries), apart.argmin(axis=1))


@pytest.mark.parametrize("seed", range(5))
def test_a_tangent_plane_is_that_of_the_eigenvectors(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(400, 3)) @ rng.normal(size=(3, 3))
    rows = rng.integers(len(points), size=(60, 9))
    normals, elongations = tangent_planes(points, rows)
    for row, normal, elongation in zip(rows, normals, elongations, strict=True):
        values, vectors = np.linalg.eigh(np.cov(points[row].T, bias=True))
        assert abs(normal @ vectors[:, 0]) == pytest.approx(1.0, abs=1e-9)
        assert elongation == pytest.approx(np.sqrt(values[2] / values[1]))


def test_points_on_one_place_or_line_have_no_plane() -> None:
    line = np.column_stack([np.arange(10.0), np.zeros(10), np.zeros(10)])
    rows = np.arange(10)[None]
    for points in (line, np.ones((10, 3))):
        normals, elongations = tangent_planes(points, rows)
        assert elongations.tolist() == [NO_PLANE]
        assert np.isfinite(normals).all()


def lines(count: int, apart_m: float, rng: np.random.Generator) -> np.ndarray:
    """Return lines of a scan on level ground, seen from the side, shape (N, 3).

    Noise lies along the rays, so that each line by itself is a band in the plane of its rays.
    """
    x, y = np.meshgrid(np.arange(0.0, 6.0, 0.05), apart_m * np.arange(count))
    range_m = rng.normal(0, 0.015, x.size)
    ray = np.array([0.0, -0.95, -0.31])
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]) + range_m[:, None] * ray


def test_planes_reach_across_the_lines_of_a_scan() -> None:
    points = lines(7, 0.4, np.random.default_rng(1))
    surface = Surface(points, 0.05, 12)
    inner = np.flatnonzero((np.abs(points[:, 0] - 3.0) < 1.5) & (np.abs(points[:, 1] - 1.2) < 0.6))
    planes = surface.planes(inner)
    assert (planes.radii_m > 0.4).all()
    assert (np.abs(planes.normals[:, 2]) > np.cos(np.radians(5))).all()


def test_a_single_line_has_no_plane() -> None:
    points = lines(1, 0.4, np.random.default_rng(1))
    assert (Surface(points, 0.05, 12).planes(np.arange(len(points))).radii_m == 0.0).all()


def test_planes_do_not_depend_on_when_they_are_asked_for() -> None:
    points = lines(4, 0.2, np.random.default_rng(2))
    rows = np.arange(len(points))
    at_once, one_by_one = Surface(points, 0.05, 12), Surface(points, 0.05, 12)
    for row in rows[::7]:
        one_by_one.planes(np.array([row]))
    for first, second in zip(at_once.planes(rows), one_by_one.planes(rows), strict=True):
        assert np.array_equal(first, second)
