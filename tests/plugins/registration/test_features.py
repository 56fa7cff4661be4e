"""Matches of descriptors, held against a search one by one."""

import numpy as np
import pytest
from executive_plugins.registration.features import Features, match

RNG = np.random.default_rng(4)


def features(count: int) -> Features:
    return Features(RNG.normal(0, 1, (count, 3)), RNG.normal(0, 1, (count, 33)))


@pytest.mark.parametrize(("targets", "sources", "nearest"), [(7, 5, 3), (2, 5, 3), (6, 1, 1)])
def test_each_source_is_matched_with_its_nearest_targets(targets, sources, nearest) -> None:
    target, source = features(targets), features(sources)
    expected = []
    for point, descriptor in zip(source.points, source.descriptors, strict=True):
        distances = [np.linalg.norm(descriptor - other) for other in target.descriptors]
        expected += [(target.points[j], point) for j in np.argsort(distances)[:nearest]]
    found, asked = match(target, source, nearest)
    assert found == pytest.approx(np.array([pair[0] for pair in expected]))
    assert asked == pytest.approx(np.array([pair[1] for pair in expected]))


@pytest.mark.parametrize(("targets", "sources", "nearest"), [(0, 4, 3), (4, 0, 3), (4, 4, 0)])
def test_nothing_to_match_is_no_match(targets, sources, nearest) -> None:
    for points in match(features(targets), features(sources), nearest):
        assert points.shape == (0, 3)
