"""How surely an aligned surface is placed, against derivatives of distances by differences."""

import numpy as np
import pytest
from executive_plugins.alignment.closeness import Closeness, weak_direction

from executive.arrays import Float
from executive.geometry.rotation import exp_so3
from executive.messages.alignment import Uncertainty


def closeness(points: Float, normals: Float, across_m: float, voxel_m: float) -> Closeness:
    return Closeness(0.0, 0.0, 0.0, 1.0, points, normals, across_m, voxel_m)


def drawn(count: int) -> tuple[Float, Float]:
    rng = np.random.default_rng(2)
    normals = rng.normal(size=(count, 3))
    return rng.uniform(-2, 2, (count, 3)) + [50.0, -20.0, 3.0], normals / np.linalg.norm(
        normals, axis=1, keepdims=True
    )


def information(points: Float, normals: Float) -> Float:
    """Return JᵀJ of the distances across the surface over small motions about the middle."""
    centre, step = points.mean(axis=0), 1e-6

    def distances(motion: Float) -> Float:
        moved = (points - centre) @ exp_so3(motion[:3]).T + centre + motion[3:]
        return np.asarray(((moved - points) * normals).sum(axis=1))

    J = np.column_stack([distances(step * e) - distances(-step * e) for e in np.eye(6)])
    J /= 2 * step
    return np.asarray(J.T @ J)


@pytest.mark.parametrize(
    ("across_m", "voxel_m", "std_m"),
    [
        (0.02, 0.25, 0.02),  # one point a patch is one observation
        (0.02, 0.5, 0.02),  # patches are no smaller than the points' distances
        (0.02, 0.05, 5 * 0.02),  # 25 points of a patch are one observation
        (0.001, 0.25, 0.005),  # no surface is known better than to 5 mm
    ],
)
def test_the_covariance_is_that_of_least_squares(
    across_m: float, voxel_m: float, std_m: float
) -> None:
    points, normals = drawn(60)
    found = closeness(points, normals, across_m, voxel_m).uncertainty()
    assert found is not None
    np.testing.assert_allclose(found.centre, points.mean(axis=0))
    expected = std_m**2 * np.linalg.inv(information(points, normals))
    np.testing.assert_allclose(found.covariance, expected, rtol=1e-3, atol=1e-9 * std_m)


@pytest.mark.parametrize(("count", "is_enough"), [(0, False), (5, False), (6, True)])
def test_fewer_points_than_unknowns_say_nothing(count: int, is_enough: bool) -> None:
    found = closeness(*drawn(count), 0.01, 0.1).uncertainty()
    assert (found is not None) is is_enough


def test_on_a_floor_nothing_is_known_of_sliding_and_heading() -> None:
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.arange(-2.0, 2.1, 0.25)] * 2))
    points = np.column_stack([x, y, np.zeros(len(x))])
    normals = np.tile([0.0, 0.0, 1.0], (len(x), 1))
    found = closeness(points, normals, 0.01, 0.25).uncertainty()
    assert found is not None
    std = np.sqrt(np.diag(found.covariance))
    assert std[5] == pytest.approx(0.01 / np.sqrt(len(x)), rel=1e-3)
    assert std[:2] == pytest.approx(np.full(2, 0.01 / np.sqrt((x**2).sum())), rel=1e-3)
    assert std[2:5].min() > 100 * std[5]
    told = weak_direction(found)
    assert "turning about (0.00, 0.00, 1.00)" in told
    assert "sliding along" in told


@pytest.mark.parametrize(("ratio", "is_weak"), [(3.9, False), (4.1, True)])
@pytest.mark.parametrize("kind", ["turning", "sliding"])
def test_a_direction_is_weak_that_is_four_times_as_uncertain_as_the_best(
    ratio: float, is_weak: bool, kind: str
) -> None:
    std = np.full(6, 0.02)
    std[1 if kind == "turning" else 4] *= ratio
    told = weak_direction(Uncertainty(np.diag(std**2), np.zeros(3)))
    if not is_weak:
        assert told == ""
    else:
        unit = {"turning": "turning about", "sliding": "sliding along"}[kind]
        assert told.startswith(f"; weak: {unit} (0.00, 1.00, 0.00), 4 times as uncertain as across")
        assert "0.08" in told
