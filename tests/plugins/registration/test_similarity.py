"""Rotation, translation and scale together."""

import numpy as np
import pytest
from executive_plugins.registration.similarity import Similarity, Surface, refine

from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between, exp_so3


def yard(seed: int) -> np.ndarray:
    """Ground and three lumps, freshly sampled by each seed."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-5, 5, (25_000, 2))
    parts = [np.column_stack([xy, 0.05 * np.sin(xy[:, 0])])]
    for centre, size in (((2, 1, 0.3), 0.6), ((-2, 2, 0.2), 0.5), ((0, -3, 0.3), 0.7)):
        d = rng.normal(size=(5000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        parts.append(d * size * [1, 0.7, 0.8] + centre)
    return np.vstack(parts) + rng.normal(0, 0.008, (40_000, 3))


@pytest.mark.parametrize("scale", [0.97, 0.99, 1.0, 1.012, 1.03])
def test_a_known_similarity_is_recovered(scale: float) -> None:
    R, t = exp_so3(np.array([0.3, -0.2, 2.0])), np.array([4.0, 5.0, -6.0])
    truth = Similarity(pose(R, t), scale)
    source = ((yard(1) - t) @ R) / scale
    off = pose(exp_so3(np.array([0.01, -0.01, 0.03])) @ R, t)
    centre = source.mean(axis=0)
    off[:3, 3] = truth.apply(centre[None])[0] + [0.08, -0.05, 0.06] - off[:3, :3] @ centre
    reaches_m = (0.4, 0.4, 0.3, 0.3, 0.2, 0.2, 0.15, 0.1, 0.1)
    found = refine(
        Surface.thinned(yard(2), 0.08), source[::4], Similarity(off, 1.0), reaches_m, 0.04
    )
    assert found.scale == pytest.approx(scale, abs=0.001)
    assert np.linalg.norm(found.apply(source) - truth.apply(source), axis=1).max() < 0.02
    assert angle_between(found.T_target_source[:3, :3], R) < np.radians(0.15)


def test_the_scale_stays_within_its_bound_and_the_centre_in_place() -> None:
    points = yard(1)
    found = refine(
        Surface.thinned(points, 0.08),
        points[::4] / 1.02,
        Similarity(np.eye(4), 1.0),
        (0.3,) * 5,
        0.005,
    )
    assert found.scale == pytest.approx(1.005)
    rigid = refine(
        Surface.thinned(points, 0.08),
        points[::4] / 1.02,
        Similarity(np.eye(4), 1.0),
        (0.3,) * 5,
        0.0,
    )
    assert rigid.scale == 1.0


def test_too_few_partners_leave_the_start_alone() -> None:
    start = Similarity(pose(None, np.array([100.0, 0, 0])), 1.0)
    assert refine(Surface.thinned(yard(1), 0.1), yard(2)[::10], start, (0.3,), 0.03) is start
