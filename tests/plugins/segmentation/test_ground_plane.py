"""The mean plane of the ground."""

import numpy as np
import pytest
from executive_plugins.segmentation.ground_plane import fit_ground_plane, fit_plane, plane_heights

from executive.errors import DataError
from executive.geometry.rotation import from_rpy

MAX_TILT_RAD = np.pi / 6


def sheet(rng: np.random.Generator, count: int = 4000) -> np.ndarray:
    return np.column_stack([rng.uniform(-8, 8, (count, 2)), rng.normal(0, 0.02, count)])


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, 0.0), (0.3, -0.2), (-0.1, 0.4)])
def test_a_tilted_plane_is_recovered_among_a_third_of_outliers(roll: float, pitch: float) -> None:
    rng = np.random.default_rng(1)
    R = from_rpy(roll, pitch, 0.7)
    clutter = np.column_stack([rng.uniform(-8, 8, (2000, 2)), rng.uniform(0.2, 2, 2000)])
    points = np.vstack([sheet(rng), clutter]) @ R.T + [0, 0, 5]
    plane = fit_ground_plane(points, 0.1, MAX_TILT_RAD, rng)
    assert np.degrees(np.arccos(min(plane[:3] @ R[:, 2], 1.0))) < 0.3  # 2 cm of noise over 16 m
    assert plane[3] == pytest.approx(5 * R[2, 2], abs=0.02)
    assert np.linalg.norm(plane[:3]) == pytest.approx(1.0)


def test_a_wall_is_no_ground() -> None:
    rng = np.random.default_rng(1)
    with pytest.raises(DataError, match=r"no ground in a cloud of 4000 points.*is z up"):
        fit_ground_plane(sheet(rng)[:, [2, 0, 1]], 0.1, MAX_TILT_RAD, rng)


def test_a_wall_of_more_points_does_not_hide_the_ground() -> None:
    rng = np.random.default_rng(1)
    wall = sheet(rng, 9000)[:, [2, 0, 1]] + [8, 0, 4]
    plane = fit_ground_plane(np.vstack([sheet(rng, 3000), wall]), 0.1, MAX_TILT_RAD, rng)
    assert plane[2] > 0.999


def test_the_plane_of_least_squares_has_the_least_squares() -> None:
    rng = np.random.default_rng(2)
    points = rng.normal(size=(200, 3)) * [3, 2, 0.3]
    plane = fit_plane(points)
    best = (plane_heights(points, plane) ** 2).sum()
    for _ in range(50):
        other = plane + rng.normal(0, 0.01, 4)
        other /= np.linalg.norm(other[:3])
        assert (plane_heights(points, other) ** 2).sum() >= best
