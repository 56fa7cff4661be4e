"""Meshes of convex solids, by their volume; colours, by their constancy."""

from itertools import product

import numpy as np
from executive_plugins.viewing.palette import of_heights, of_number
from executive_plugins.viewing.solids import mesh


def volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """The divergence theorem; positive only if every triangle faces outward."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def parts(hulls: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    solid = mesh(hulls, (10, 20, 30))
    vertices, triangles, normals = (
        np.array(batch.as_arrow_array().to_pylist())
        for batch in (solid.vertex_positions, solid.triangle_indices, solid.vertex_normals)
    )
    return vertices, triangles, normals


def test_a_box_has_its_volume_wherever_it_stands() -> None:
    box = np.array(list(product((0, 2), (0, 3), (0, 0.5)))) + np.array([10.0, -4.0, 1.0])
    vertices, triangles, _ = parts([box])
    assert abs(volume(vertices, triangles) - 3.0) < 1e-4


def test_volumes_of_several_hulls_add_up() -> None:
    box = np.array(list(product((-0.5, 0.5), repeat=3)))
    vertices, triangles, _ = parts([box, box + 5.0])
    assert abs(volume(vertices, triangles) - 2.0) < 1e-4


def test_normals_point_away_from_the_middle() -> None:
    points = np.random.default_rng(0).normal(0, 1, (40, 3))
    vertices, _, normals = parts([points])
    assert (np.einsum("ij,ij->i", vertices - points.mean(axis=0), normals) > 0).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)


def test_neighbouring_numbers_have_distinct_and_constant_colours() -> None:
    colours = [of_number(k) for k in range(8)]
    assert colours == [of_number(k) for k in range(8)]
    distances = [
        np.linalg.norm(np.subtract(a, b)) for i, a in enumerate(colours) for b in colours[:i]
    ]
    assert min(distances) > 25


def test_heights_rise_from_dark_to_light() -> None:
    colours = of_heights(np.linspace(-1, 2, 50)).astype(int).sum(axis=1)
    assert (np.diff(colours) >= 0).all()
    assert colours[-1] > colours[0]
    assert of_heights(np.zeros(0)).shape == (0, 3)
    assert of_heights(np.ones(4)).shape == (4, 3)
