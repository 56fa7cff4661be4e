"""Whole segmentation of a rough site with stones that touch, crumbs, slabs, walls and heaps."""

import numpy as np
import pytest
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.errors import DataError
from executive.messages.cloud import Cloud


def stone(rng: np.random.Generator, middle, sizes, count: int = 900) -> np.ndarray:
    d = rng.normal(size=(count, 3))
    d *= np.asarray(sizes) / np.linalg.norm(d, axis=1)[:, None]
    return d[d[:, 2] > -0.1] + middle


def site(normals: bool = False) -> Cloud:
    rng = np.random.default_rng(4)
    xy = rng.uniform(-5, 5, (9000, 2))
    ground = np.column_stack([xy, 0.05 * np.sin(xy[:, 0]) + 0.02 * xy[:, 1]])
    box = rng.uniform(0, 1, (1500, 3))
    parts = [
        ground,
        stone(rng, (2, 0, 0.2), (0.5, 0.4, 0.4)),
        stone(rng, (2.95, 0, 0.2), (0.45, 0.4, 0.35)),
        stone(rng, (-2, 2, 0.1), (0.4, 0.5, 0.3)),
        stone(rng, (-2, -2, 0.1), (0.11, 0.11, 0.2), 300),  # too small
        stone(rng, (0, 3, 0.0), (0.3, 0.3, 0.15), 500),  # too low
        stone(rng, (0, -3, 0.1), (0.3, 0.3, 0.3), 55),  # too thin
        box * [0.02, 1.2, 0.8] + [4, 2, 0.1],  # a slab: flat
        box * [3.5, 0.3, 0.5] + [-4.5, -4, 0.1],  # too long
    ]
    points = np.vstack(parts) + [30, -20, 400]
    ups = np.tile([0.0, 0, 1], (len(points), 1)) if normals else None
    return Cloud("map", points, ups)


@pytest.mark.parametrize("changed", [{}, {"voxel_m": 0.2, "seed": 3}, {"max_extent_m": 5.0}])
def test_site(recorded, changed) -> None:
    segmenter = GroundAndClusters(GroundAndClustersSettings(**changed))
    recorded(segmenter.segment(site(normals=not changed)))


def test_too_few_points(recorded) -> None:
    segmenter = GroundAndClusters(GroundAndClustersSettings())
    level = np.random.default_rng(0).uniform(-1, 1, (60, 3)) * [1, 1, 0]
    with pytest.raises(DataError) as refused:
        segmenter.segment(Cloud("map", level[:59]))
    recorded((refused.value, segmenter.segment(Cloud("map", level))))


def test_merged_clouds(recorded) -> None:
    segmenter = GroundAndClusters(GroundAndClustersSettings(merged_voxel_m=0.5))
    rng = np.random.default_rng(1)
    a, b = (Cloud("map", rng.integers(-8, 8, (60, 3)) / 8) for _ in range(2))
    refusals = []
    for clouds in ([], [a, Cloud("survey", np.zeros((1, 3)))]):
        with pytest.raises(DataError) as refused:
            segmenter.merge(clouds)
        refusals.append(refused.value)
    recorded((segmenter.merge([a, b]), refusals))
