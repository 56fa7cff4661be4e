"""What every segmenter must do, whatever its method."""

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial import cKDTree

from executive import registry
from executive.errors import DataError
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud

SPOTS = np.array([[3.0, 0.0], [0.0, 4.0], [-3.5, -2.0]])


@pytest.fixture(params=[plugin.name for plugin in registry.installed("segmentation")])
def segmenter(request: pytest.FixtureRequest) -> Iterator[Segmenter]:
    plugin = registry.load("segmentation", request.param)
    services = {"rng": np.random.default_rng(0)}
    segmenter = plugin(
        plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin))
    )
    segmenter.start()
    yield segmenter
    segmenter.close()


def site(shift: np.ndarray | float = 0.0) -> np.ndarray:
    """Level ground and three half-buried boulders of different sizes, 1 cm of noise."""
    rng = np.random.default_rng(0)
    xy = rng.uniform(-7, 7, (30_000, 2))
    parts = [np.column_stack([xy, np.zeros(len(xy))])]
    for k, spot in enumerate(SPOTS):
        d = rng.normal(size=(4000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        boulder = d * (0.5 + 0.1 * k) * [1, 0.8, 0.9] + [*spot, 0.2]
        parts.append(boulder[boulder[:, 2] > 0])
    points = np.vstack(parts)
    return points + rng.normal(0, 0.01, points.shape) + shift


def test_it_is_a_segmenter(segmenter: Segmenter) -> None:
    assert isinstance(segmenter, Segmenter)


def test_it_finds_boulders_and_ground_in_the_clouds_own_frame(segmenter: Segmenter) -> None:
    shift = np.array([100.0, -50.0, 7.0])
    found = segmenter.segment(Cloud("somewhere", site(shift)))
    assert found.frame == found.ground.frame == "somewhere"
    assert len(found.segments) == len(SPOTS)
    centroids = np.array([segment.centroid for segment in found.segments]) - shift
    assert np.linalg.norm(SPOTS[:, None] - centroids[:, :2], axis=2).min(axis=1).max() < 0.1
    assert found.ground_plane[2] > 0.99
    assert found.ground_plane[3] == pytest.approx(found.ground_plane[:3] @ shift, abs=0.05)
    assert np.linalg.norm(found.ground_plane[:3]) == pytest.approx(1.0)


def test_segments_describe_themselves(segmenter: Segmenter) -> None:
    found = segmenter.segment(Cloud("map", site())).segments
    assert [segment.id for segment in found] == list(range(len(found)))
    assert [len(s.points) for s in found] == sorted((len(s.points) for s in found), reverse=True)
    for segment in found:
        np.testing.assert_allclose(segment.centroid, segment.points.mean(axis=0), atol=1e-9)
        assert (np.diff(segment.extents) <= 0).all()
        assert segment.extents[0] <= np.linalg.norm(np.ptp(segment.points, axis=0)) + 1e-9


def test_points_are_points_of_the_cloud(segmenter: Segmenter) -> None:
    cloud = {tuple(p) for p in site().round(6)}
    found = segmenter.segment(Cloud("map", site()))
    for part in (found.ground.points, *(s.points for s in found.segments)):
        assert {tuple(p) for p in part.round(6)} <= cloud


def test_the_same_cloud_gives_the_same_segments(segmenter: Segmenter) -> None:
    first, second = (segmenter.segment(Cloud("map", site())) for _ in range(2))
    np.testing.assert_array_equal(first.ground_plane, second.ground_plane)
    for a, b in zip(first.segments, second.segments, strict=True):
        np.testing.assert_array_equal(a.points, b.points)


def test_the_cloud_stays_as_it_was(segmenter: Segmenter) -> None:
    points = site()
    segmenter.segment(Cloud("map", points))
    np.testing.assert_array_equal(points, site())


def test_nothing_has_no_ground(segmenter: Segmenter) -> None:
    with pytest.raises(DataError, match="cloud"):
        segmenter.segment(Cloud("map", np.empty((0, 3))))


def test_merged_clouds_are_of_one_density_and_keep_what_one_alone_shows(
    segmenter: Segmenter,
) -> None:
    whole = site()
    left, right = whole[whole[:, 0] < 0.5], whole[whole[:, 0] > -0.5]
    merged = segmenter.merge([Cloud("map", left), Cloud("map", np.repeat(right, 3, axis=0))])
    assert merged.frame == "map"
    assert len(merged) <= len(whole)
    assert cKDTree(merged.points).query(whole)[0].max() < 0.1
    assert len(segmenter.segment(merged).segments) == len(SPOTS)


def test_merging_does_not_depend_on_the_order(segmenter: Segmenter) -> None:
    a, b = Cloud("map", site()), Cloud("map", site(0.02))
    np.testing.assert_allclose(
        segmenter.merge([a, b]).points, segmenter.merge([b, a]).points, atol=1e-9
    )


def test_clouds_of_several_frames_are_not_merged(segmenter: Segmenter) -> None:
    with pytest.raises(DataError, match="drone, map"):
        segmenter.merge([Cloud("map", site()), Cloud("drone", site())])
    with pytest.raises(DataError, match="no cloud"):
        segmenter.merge([])


def test_an_empty_cloud_adds_nothing(segmenter: Segmenter) -> None:
    empty, full = Cloud("map", np.empty((0, 3))), Cloud("map", site())
    np.testing.assert_array_equal(
        segmenter.merge([empty, full]).points, segmenter.merge([full]).points
    )
    assert len(segmenter.merge([empty])) == 0
