"""Planes between bodies: what they separate is apart, and what is too close stays in question."""

import fcl
import numpy as np
import pytest
from executive_plugins.motion.separation import unseparated
from executive_plugins.physics.fcl_convex import fcl_convex
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.hull_mesh import mesh_of
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3

CLEARANCE_M = 0.05


def bodies(rng: np.random.Generator, count: int) -> list[tuple[Float, fcl.CollisionObject]]:
    found = []
    for _ in range(count):
        corners, faces = mesh_of(ConvexHull(rng.normal(0, rng.uniform(0.05, 0.4, 3), (20, 3))))
        found.append((corners, fcl.CollisionObject(fcl_convex(corners, faces))))
    return found


def distances(
    one: fcl.CollisionObject, other: fcl.CollisionObject, T: Float, T_other: Float
) -> Float:
    found = []
    for pair in zip(T, T_other, strict=True):
        for body, at in zip((one, other), pair, strict=True):
            body.setTransform(fcl.Transform(at[:3, :3], at[:3, 3]))
        found.append(fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult()))
    return np.array(found)


@pytest.mark.parametrize("seed", range(3))
def test_no_pair_that_is_too_close_is_excluded_and_few_others_are_left(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (corners, one), (others, other) = bodies(rng, 2)
    way = np.linspace([-1.5, 0.1, 0.0], [1.5, 0.1, 0.3], 200)
    T = np.array([pose(exp_so3(np.array([0.0, 0.0, 4 * p[0]])), p) for p in way])
    still = np.tile(np.eye(4), (len(T), 1, 1))
    left = unseparated(
        np.array([still, T]),
        np.array([0, 1]),
        np.vstack([corners, others]),
        np.array([0, len(corners), len(corners) + len(others)]),
        np.array([[0, 1]]),
        CLEARANCE_M,
    )
    in_question = np.zeros(len(T), dtype=bool)
    in_question[left[:, 0]] = True
    away_m = distances(one, other, still, T)
    assert in_question[away_m < CLEARANCE_M].all()
    assert (away_m < CLEARANCE_M).any()
    assert in_question[away_m >= CLEARANCE_M].mean() < 0.1
    assert (np.diff(left[:, 0]) > 0).all()


def test_postures_come_in_order_and_pairs_in_each_of_them() -> None:
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    T = np.tile(np.eye(4), (2, 1, 1))
    found = unseparated(
        T[None],
        np.array([0, 0, 0]),
        np.vstack([cube, cube + 0.5, cube + (5, 0, 0)]),
        np.array([0, 8, 16, 24]),
        np.array([[1, 0], [2, 0], [0, 1]]),
        CLEARANCE_M,
    )
    assert found.tolist() == [[0, 0], [0, 2], [1, 0], [1, 2]]
