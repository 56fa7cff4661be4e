"""The compiled loops over beams, against matrix products and against casting every ray."""

import numpy as np
from executive_plugins.robot.mujoco.sensors.beams import (
    beams_in_world,
    beams_towards,
    returned_points,
)
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh, RayMesh

from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.rotation import exp_so3

COLUMNS, LASERS = 40, 16


def unit_vectors(rng: np.random.Generator, *shape: int) -> np.ndarray:
    vectors = rng.standard_normal((*shape, 3))
    return (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).astype(np.float32)


def test_beams_are_turned_and_moved_with_their_column() -> None:
    rng = np.random.default_rng(26127111)
    directions = unit_vectors(rng, COLUMNS, LASERS)
    origins = rng.normal(0, 5, (COLUMNS, 3))
    rotations = np.array([exp_so3(turn) for turn in rng.normal(0, 1, (COLUMNS, 3))])
    which = np.sort(rng.choice(COLUMNS * LASERS, 300, replace=False))
    rays = beams_in_world(directions, which, origins, rotations)
    assert rays.dtype == np.float32
    turned = directions.astype(np.float64) @ rotations.transpose(0, 2, 1)
    np.testing.assert_allclose(rays[:, 3:], turned.reshape(-1, 3)[which], atol=3e-7)
    np.testing.assert_array_equal(rays[:, :3], origins.astype(np.float32)[which // LASERS])


def test_points_lie_along_their_beams() -> None:
    rng = np.random.default_rng(26127112)
    directions = unit_vectors(rng, COLUMNS, LASERS)
    which = np.sort(rng.choice(COLUMNS * LASERS, 200, replace=False))
    ranges = rng.uniform(1, 60, len(which))
    points = returned_points(directions, which, ranges)
    np.testing.assert_array_equal(points, directions.reshape(-1, 3)[which] * ranges[:, None])


def boulder(rng: np.random.Generator) -> Mesh:
    return hull_mesh(rng.normal(0, 0.5, (30, 3)) + 6 * unit_vectors(rng))


def test_every_ray_that_hits_a_part_passes_through_its_box_and_most_others_do_not() -> None:
    rng = np.random.default_rng(26127113)
    parts = [boulder(rng) for _ in range(3)]
    rays = np.zeros((20_000, 6), dtype=np.float32)
    rays[:, 3:] = unit_vectors(rng, len(rays))
    low, high = (
        np.array([edge(vertices, axis=0) for vertices, _ in parts], dtype=np.float32)
        for edge in (np.min, np.max)
    )
    do_pass = beams_towards(np.ascontiguousarray(1 / rays[:, 3:].T), low - 1e-3, high + 1e-3)
    do_hit = np.isfinite(RayMesh(parts).cast(rays))
    assert do_hit.sum() > 50
    assert not (do_hit & ~do_pass).any()
    assert do_pass.sum() < 4 * do_hit.sum()


def test_a_ray_along_an_axis_passes_through_the_box_before_it_and_not_the_one_behind() -> None:
    along = np.array([[0.0, 0.0, 1.0]], dtype=np.float32)
    inverse = np.ascontiguousarray(1 / np.where(along, along, 1e-9).T, dtype=np.float32)
    box = np.array([[-0.1, -0.1, 2.0]], dtype=np.float32), np.array([[0.1, 0.1, 3.0]], np.float32)
    assert beams_towards(inverse, *box).all()
    assert not beams_towards(-inverse, *box).any()
    assert not beams_towards(inverse, box[0] + 1, box[1] + 1).any()
