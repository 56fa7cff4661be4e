"""A fit finds a known motion, and which directions the scene does not constrain."""

import numpy as np
import pytest
from executive_plugins.odometry.plane_fit import Guess, fit
from executive_plugins.odometry.plane_map import PlaneMap

from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3, log_so3

STD = np.repeat([0.05, 0.1], 3)
GROUND = np.array([[0, 0, 1.0, 0]])
CORNER = np.array([[0, 0, 1.0, 0], [1.0, 0, 0, 4], [0, 1.0, 0, 4]])


def surface(planes: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Points on faces of ±4 m, 10 mm rough."""
    parts = []
    for *normal, offset in planes:
        normal = np.array(normal)
        flat = rng.uniform(-4, 4, (count, 3))
        parts.append(flat - np.outer(flat @ normal - offset - rng.normal(0, 0.01, count), normal))
    return np.vstack(parts)


def mapped(planes: np.ndarray, rng: np.random.Generator) -> PlaneMap:
    plane_map = PlaneMap(0.15, 0.45, 16, 10)
    plane_map.add(np.eye(4), surface(planes, 4000, rng))
    return plane_map


def errors(planes: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Errors of fits in the lidar's frame (count, 6), and what each claims for its variance."""
    rng = np.random.default_rng(1)
    plane_map = mapped(planes, rng)
    rows, claims = [], []
    for _ in range(count):
        truth = pose(exp_so3(rng.normal(0, 0.02, 3)), rng.normal(0, 0.03, 3))
        points = transform(inverse(truth), surface(planes, 500, rng))
        fitted = fit(points, plane_map, Guess(np.eye(4), STD), 1.0, 0.3)
        assert fitted.has_converged
        E = inverse(truth) @ fitted.T_map_lidar
        rows.append(np.concatenate([log_so3(E[:3, :3]), E[:3, 3]]))
        claims.append(np.diag(fitted.covariance))
    return np.array(rows), np.array(claims)


def test_a_corner_constrains_all_six_directions() -> None:
    error, claim = errors(CORNER, 12)
    assert np.abs(error[:, :3]).max() < 0.002
    assert np.abs(error[:, 3:]).max() < 0.006
    assert np.sqrt(claim).max() < 0.003


def test_level_ground_leaves_heading_and_two_directions_to_the_guess() -> None:
    error, claim = errors(GROUND, 6)
    std = np.sqrt(claim.mean(axis=0))
    np.testing.assert_allclose(std[2:5], STD[2:5], rtol=0.05)
    assert std[[0, 1, 5]].max() < 0.003
    assert np.abs(error[:, [0, 1]]).max() < 0.003


def test_a_scan_of_an_unknown_place_has_no_points_on_planes() -> None:
    rng = np.random.default_rng(2)
    fitted = fit(
        rng.uniform(20, 40, (300, 3)), mapped(CORNER, rng), Guess(np.eye(4), STD), 1.0, 0.3
    )
    assert fitted.share == 0
    np.testing.assert_allclose(np.sqrt(np.diag(fitted.covariance)), STD)


@pytest.mark.parametrize("count", [0, 5])
def test_too_few_points_are_a_map_without_planes(count: int) -> None:
    plane_map = PlaneMap(0.15, 0.45, 16, 10)
    plane_map.add(np.eye(4), np.zeros((count, 3)))
    assert len(plane_map.planes.points) == 0
    assert not plane_map.nearest(np.zeros((3, 3)), 1.0)[0].any()
