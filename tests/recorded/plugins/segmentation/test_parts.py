"""The steps of segmentation on small grids, where gaps, heights and counts meet limits exactly."""

import itertools

import numpy as np
import pytest
from executive_plugins.segmentation.cluster_splitting import ClusterSplitter
from executive_plugins.segmentation.clusters import connected_clusters
from executive_plugins.segmentation.ground_plane import (
    fit_ground_plane,
    fit_plane,
    plane_heights,
)
from executive_plugins.segmentation.ground_surface import SurfaceFit
from executive_plugins.segmentation.shape import (
    counts_near,
    moments,
    planes_through,
    principal_extents,
    spans,
    spans_along,
)
from executive_plugins.segmentation.watershed import basins

from executive.errors import DataError


def cloud(seed: int, count: int = 40) -> np.ndarray:
    """Return points on a grid of eighths."""
    return np.random.default_rng(seed).integers(-16, 16, (count, 3)) / 8.0


def test_shape(recorded) -> None:
    points = cloud(1)
    triples = np.random.default_rng(2).integers(0, 40, (3, 60))
    triples[:, :3] = triples[0, :3]  # without a plane
    planes = planes_through(points, triples)
    upright = np.array([[0.0, 0, 1, 0], [0.0, 0, 1, 0.25], [1.0, 0, 0, -0.5]])
    recorded(
        (
            moments(points),
            moments(points[:1]),
            spans(points),
            spans_along(points, np.linalg.qr(cloud(3, 3))[0]),
            principal_extents(points),
            planes,
            counts_near(points, planes, 0.1),
            counts_near(points, upright, 0.25),
        )
    )


@pytest.mark.parametrize("voxel_m", [0.25, 0.5, 1.0])
def test_clusters(recorded, voxel_m) -> None:
    told = []
    for seed, groups in itertools.product(range(6), (1, 2)):
        points = cloud(seed, 9 + 12 * seed)
        of = np.arange(len(points)) % groups
        told.append(connected_clusters(points, of, voxel_m))
    recorded([labels.tolist() for labels in told])


def test_neighbours_in_every_direction_join(recorded) -> None:
    """Two points apart by one or two voxels along each of 124 directions."""
    told = []
    for offset in itertools.product((-2, -1, 0, 1, 2), repeat=3):
        points = np.array([[0.5, 0.5, 0.5], np.add(offset, 0.5), [9.5, 9.5, 9.5]])
        told.append(connected_clusters(points, np.zeros(3, dtype=np.int64), 1.0).tolist())
    recorded(np.array(told))


@pytest.mark.parametrize("least_cells", [0, 2, 4])
@pytest.mark.parametrize("least_drop", [0.25, 0.5])
def test_watershed(recorded, least_drop, least_cells) -> None:
    told = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        places = np.stack(np.meshgrid(np.arange(7), np.arange(6)), axis=-1).reshape(-1, 2) + 0.5
        heights = rng.integers(0, 5, len(places)) / 4.0
        told.append(basins(places, heights, 1.0, least_drop, least_cells))
        thin = rng.random(len(places)) < 0.6
        told.append(basins(places[thin], heights[thin], 1.0, least_drop, least_cells))
    recorded([basin.tolist() for basin in told])


def test_planes(recorded) -> None:
    points = cloud(5, 30)
    points[:, 2] = 0.25 * points[:, 0] + 0.125 * np.sign(points[:, 1])
    down = points * [1, 1, -1]
    recorded((fit_plane(points), fit_plane(down), plane_heights(points, fit_plane(points))))


@pytest.mark.parametrize("count", [60, 1999, 2001])
@pytest.mark.parametrize("tilt_rad", [0.0, 0.3])
def test_ground_plane(recorded, count, tilt_rad) -> None:
    points = np.random.default_rng(6).uniform(-4, 4, (count, 3)) * [1, 1, 0.25]
    points[::3, 2] = np.tan(tilt_rad) * points[::3, 0] + 0.02 * np.sin(points[::3, 1])
    rng = np.random.default_rng(7)
    recorded([fit_ground_plane(points, margin, 0.35, rng) for margin in (0.05, 0.3)])


def test_no_ground(recorded) -> None:
    wall = cloud(8) * [0, 1, 1]
    few = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0.0], [5, 5, 5]])
    with pytest.raises(DataError) as refused:
        fit_ground_plane(wall, 0.1, 0.5, np.random.default_rng(1))
    recorded((refused.value, fit_ground_plane(few, 1e-12, 0.5, np.random.default_rng(1))))


def test_ground_surface(recorded) -> None:
    told = []
    for shape, node_m, stiffness in (
        ((5, 3), 1.0, 0.2),
        ((2, 6), 0.5, 1.0),
        ((0.2, 0.2), 1.0, 0.1),
    ):
        rng = np.random.default_rng(9)
        points = rng.uniform(0, 1, (900, 3)) * [*shape, 0.05]
        points[:, 2] += 0.1 * np.sin(points[:, 0]) + np.where(rng.random(900) < 0.2, 0.4, 0.0)
        plane = np.array([0.0, 0.6, 0.8, 0.1]) if shape[0] == 2 else np.array([0.0, 0, 1, 0.05])
        fit = SurfaceFit(node_m, 0.1, 0.36, stiffness)
        surface = fit.on(fit.level(points, plane))
        corners = rng.uniform(-1, 8, (40, 3))
        told.append(
            (surface, surface.heights_above(corners), surface.heights_above(points, corners[0]))
        )
    wide = np.diag([1500.0, 3000.0, 0.0])
    with pytest.raises(DataError) as refused:
        SurfaceFit(1.0, 0.1, 0.36, 0.5).level(wide, np.array([0.0, 0, 1, 0]))
    recorded((told, refused.value))


def test_splits(recorded) -> None:
    """Two heaps nearer and nearer, dense and thin; a crumb beside them."""
    told = []
    for gap_m, step_m, share in itertools.product(
        (0.0, 0.06, 0.12, 0.3), (0.04, 0.05, 0.09), (0.5, 0.95)
    ):
        x, y = (one.ravel() for one in np.mgrid[-0.3:0.3:step_m, -0.2:0.2:step_m])
        dome = np.column_stack([x, y, 0.5 - 2 * x**2 - 3 * y**2])
        other = dome * [0.7, 1, 0.6] + [0.55 + gap_m, 0.02, 0]
        crumb = dome[:6] * 0.3 + [0.3, 0.4, 0.0]
        points = np.vstack([dome, other, crumb])
        splitter = ClusterSplitter(0.08, 0.05, 0.3, 20, 0.25, 0.16, share)
        rows = splitter.split(points, points[:, :2], points[:, 2])
        told.append([len(points), *(len(part) for part in rows), *(int(p.sum()) for p in rows)])
    recorded(told)
