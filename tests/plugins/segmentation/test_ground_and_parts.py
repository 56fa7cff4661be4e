"""Stones that touch are parted along the concave border between them."""

import numpy as np
import pytest
from executive_plugins.segmentation.average_linkage import average_linkage
from executive_plugins.segmentation.ground_and_parts import GroundAndParts
from executive_plugins.segmentation.patch_graph import patch_graph
from executive_plugins.segmentation.settings import GroundAndPartsSettings
from pydantic import ValidationError

from executive.arrays import Float
from executive.errors import DataError
from executive.messages.cloud import Cloud

Place = tuple[float, float, float]
RADII_M = np.array([0.45, 0.45, 0.36])


def seen(*centres: Place) -> Float:
    """Return what is seen from above of flattened balls that cut into each other a little [m]."""
    rng, parts = np.random.default_rng(1), []
    for centre in centres:
        d = rng.normal(size=(6000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        points = (d * RADII_M + centre)[d[:, 2] > -0.1]
        others = [other for other in centres if other != centre]
        depths = [np.linalg.norm((points - other) / RADII_M, axis=1) for other in others]
        parts.append(points[np.min([np.full(len(points), 9.0), *depths], axis=0) > 1.0])
    points = np.vstack(parts)
    return np.asarray(points + rng.normal(0, 0.006, points.shape))


def site(*lumps: Float) -> Cloud:
    rng = np.random.default_rng(9)
    ground = np.column_stack([rng.uniform(-4, 4, (20_000, 2)), rng.normal(0, 0.006, 20_000)])
    return Cloud("map", np.vstack([ground, *lumps]))


def segments(cloud: Cloud) -> list[Float]:
    return [
        one.centroid for one in GroundAndParts(GroundAndPartsSettings()).segment(cloud).segments
    ]


def test_one_stone_stays_one() -> None:
    assert len(segments(site(seen((0, 0, 0.3))))) == 1


def test_touching_stones_are_parted() -> None:
    found = segments(site(seen((-0.4, 0, 0.3), (0.4, 0, 0.3))))
    assert sorted(round(float(c[0]), 1) for c in found) == pytest.approx([-0.4, 0.4], abs=0.11)


def test_a_stone_on_two_others_is_parted_from_them() -> None:
    found = segments(site(seen((-0.5, 0, 0.3), (0.5, 0, 0.3), (0, 0, 0.8))))
    assert len(found) == 3
    assert max(float(c[2]) for c in found) > 0.7


def test_a_ball_is_convex_everywhere_and_a_seam_is_not() -> None:
    ball = patch_graph(seen((0, 0, 2.0)), 0.12)
    assert np.median(ball.angles_rad) > 0.1
    both = seen((-0.4, 0, 2.0), (0.4, 0, 2.0))
    both = both[np.abs(both[:, 0]) < 0.15]
    assert patch_graph(both, 0.12).angles_rad.min() < -0.5


def test_one_wrong_edge_joins_no_groups() -> None:
    inside = [(0, 1), (1, 2), (0, 2), (3, 4), (4, 5), (3, 5)]
    border = [(2, 3), (1, 4), (0, 5)]
    weights = np.array([1.0] * 6 + [0.5, -1.0, -1.0])
    assert average_linkage(6, np.array(inside + border), weights).tolist() == [0, 0, 0, 1, 1, 1]


def test_a_weight_for_each_pair_is_needed() -> None:
    with pytest.raises(DataError, match="1 weights for 2 pairs"):
        average_linkage(3, np.array([(0, 1), (1, 2)]), np.ones(1))


def test_patches_without_an_edge_are_refused() -> None:
    with pytest.raises(ValidationError, match="patch_m"):
        GroundAndPartsSettings(patch_m=0)
