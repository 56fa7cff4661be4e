"""What every segmenter must do, whatever its method."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from executive.errors import DataError
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud
from executive.testing.exercises.segmentation import SPOTS, site
from executive.testing.pytest_plugin import Insist

CAPABILITY = "segmentation"


def test_it_finds_boulders_and_ground_in_the_clouds_own_frame(
    plugin: Segmenter, insist: Insist
) -> None:
    shift = np.array([100.0, -50.0, 7.0])
    found = plugin.segment(Cloud("somewhere", site(shift)))
    assert found.frame == found.ground.frame == "somewhere"
    insist(found.segments, "it finds nothing on a site with three boulders")
    assert len(found.segments) == len(SPOTS)
    centroids = np.array([segment.centroid for segment in found.segments]) - shift
    assert np.linalg.norm(SPOTS[:, None] - centroids[:, :2], axis=2).min(axis=1).max() < 0.1
    assert found.ground_plane[2] > 0.99
    assert found.ground_plane[3] == pytest.approx(found.ground_plane[:3] @ shift, abs=0.05)
    assert np.linalg.norm(found.ground_plane[:3]) == pytest.approx(1.0)


def test_segments_describe_themselves(plugin: Segmenter) -> None:
    found = plugin.segment(Cloud("map", site())).segments
    assert [segment.id for segment in found] == list(range(len(found)))
    assert [len(s.points) for s in found] == sorted((len(s.points) for s in found), reverse=True)
    for segment in found:
        np.testing.assert_allclose(segment.centroid, segment.points.mean(axis=0), atol=1e-9)
        assert (np.diff(segment.extents) <= 0).all()
        assert segment.extents[0] <= np.linalg.norm(np.ptp(segment.points, axis=0)) + 1e-9


def test_points_are_points_of_the_cloud(plugin: Segmenter) -> None:
    cloud = {tuple(p) for p in site().round(6)}
    found = plugin.segment(Cloud("map", site()))
    for part in (found.ground.points, *(s.points for s in found.segments)):
        assert {tuple(p) for p in part.round(6)} <= cloud
    ground = {tuple(p) for p in found.ground.points.round(6)}
    for segment in found.segments:
        assert {tuple(p) for p in segment.foot.round(6)} <= ground


def test_nothing_has_no_ground(plugin: Segmenter) -> None:
    with pytest.raises(DataError, match="cloud"):
        plugin.segment(Cloud("map", np.empty((0, 3))))


def test_merged_clouds_are_of_one_density_and_keep_what_one_alone_shows(
    plugin: Segmenter,
) -> None:
    whole = site()
    left, right = whole[whole[:, 0] < 0.5], whole[whole[:, 0] > -0.5]
    merged = plugin.merge([Cloud("map", left), Cloud("map", np.repeat(right, 3, axis=0))])
    assert merged.frame == "map"
    assert len(merged) <= len(whole)
    assert cKDTree(merged.points).query(whole)[0].max() < 0.1
    assert len(plugin.segment(merged).segments) == len(plugin.segment(Cloud("map", whole)).segments)


def test_merging_does_not_depend_on_the_order(plugin: Segmenter) -> None:
    a, b = Cloud("map", site()), Cloud("map", site(0.02))
    np.testing.assert_allclose(plugin.merge([a, b]).points, plugin.merge([b, a]).points, atol=1e-9)


def test_clouds_of_several_frames_are_not_merged(plugin: Segmenter) -> None:
    with pytest.raises(DataError, match="drone, map"):
        plugin.merge([Cloud("map", site()), Cloud("drone", site())])
    with pytest.raises(DataError, match="no cloud"):
        plugin.merge([])


def test_an_empty_cloud_adds_nothing(plugin: Segmenter) -> None:
    empty, full = Cloud("map", np.empty((0, 3))), Cloud("map", site())
    np.testing.assert_array_equal(plugin.merge([empty, full]).points, plugin.merge([full]).points)
    assert len(plugin.merge([empty])) == 0
