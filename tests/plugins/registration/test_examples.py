"""What is accepted and how exactly, on generated clouds of every kind and on four given ones."""

from typing import Any

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.registration.segment_fpfh import SegmentFpfh
from executive_plugins.registration.segment_registrar import SegmentRegistrar
from executive_plugins.registration.segment_shot import SegmentShot
from executive_plugins.registration.settings import SegmentFpfhSettings, SegmentShotSettings
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from scipy.spatial import cKDTree

from executive.geometry.pose import transform
from executive.geometry.rotation import angle_between


@pytest.fixture(params=[(SegmentFpfh, SegmentFpfhSettings), (SegmentShot, SegmentShotSettings)])
def registrar(request: pytest.FixtureRequest) -> SegmentRegistrar:
    plugin, settings = request.param
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    made: SegmentRegistrar = plugin(settings(), segmentation, Gicp(GicpSettings()))
    made.start()
    return made


def test_an_example_is_registered_exactly_or_refused(
    registrar: SegmentRegistrar, example: Any
) -> None:
    found = registrar.register(example.target, example.source, np.random.default_rng(0))
    assert found.accepted == example.is_same_site, found.reason
    if example.is_same_site:
        T = example.T_target_source
        assert example.errors(found.apply)[1] < 0.05
        assert angle_between(found.T_target_source[:3, :3], T[:3, :3]) < np.radians(1.0)
        assert found.scale == pytest.approx(1 / example.stretch, abs=0.003)


def test_the_views_of_an_example_overlap_in_part(example: Any) -> None:
    """The drone sees sides of stones that the lidars do not, and most of the rest alike."""
    if not example.is_same_site:
        pytest.skip("two sites have no stone in common")
    survey = transform(example.T_target_source, example.source.points)
    survey = example.centre + (survey - example.centre) / example.stretch
    on_stone = cKDTree(example.stones).query(survey, distance_upper_bound=0.6)[0] < 0.6
    far = cKDTree(example.target.points).query(survey[on_stone])[0] > 0.10
    assert 0.02 < far.mean() < 0.4
