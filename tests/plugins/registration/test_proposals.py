"""What keypoints propose: the motion between two views of the same lumps; nothing of nothing."""

import os
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.registration import kiss_matcher
from executive_plugins.registration.fpfh_features import describe
from executive_plugins.registration.kiss_matcher import FasterPfh, KissMatcher
from executive_plugins.registration.segment_fpfh import (
    FpfhAndConstellation,
    SegmentFpfh,
    load_open3d,
)
from executive_plugins.registration.settings import KissMatcherSettings, SegmentFpfhSettings
from executive_plugins.registration.stopwatch import Stopwatch
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation

T = pose(from_rpy(0.03, -0.02, 0.7), np.array([1.0, -2.0, 0.3]))


def lump(number: int) -> Float:
    """Return points on a bumpy ball of half a metre, other bumps for each number [m]."""
    d = np.random.default_rng(7).normal(size=(1500, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    waves = np.random.default_rng(number).normal(0, 3, (3, 3))
    return np.asarray(d * (0.5 + 0.06 * np.sin(d @ waves).sum(axis=1))[:, None])


def seen(T_frame_site: Float) -> Segmentation:
    """Return three lumps and their ground, expressed in a frame."""
    places = [[0.0, 0, 0.3], [2.5, 0.3, 0.3], [0.5, 3.1, 0.3]]
    parts = [transform(T_frame_site, lump(i) + np.array(place)) for i, place in enumerate(places)]
    segments = tuple(
        Segment(i, part, part.mean(axis=0), np.ptp(part, axis=0)) for i, part in enumerate(parts)
    )
    ground = transform(T_frame_site, np.zeros((1, 3)))
    normal = T_frame_site[:3, 2]
    plane = np.append(normal, normal @ ground[0])
    return Segmentation("map", segments, Cloud("map", ground), plane)


def off_m(T_found: Float) -> float:
    """Return how far a motion takes the places of the lumps from where T does [m]."""
    places = np.array([[0.0, 0, 0], [2.5, 0, 0], [0, 3, 0]])
    return float(np.linalg.norm(transform(T_found, places) - transform(T, places), axis=1).max())


def test_fpfh_proposes_the_motion_from_matches_and_from_where_the_segments_stand() -> None:
    watch = Stopwatch()
    proposer = FpfhAndConstellation(SegmentFpfhSettings(candidates=2))
    proposed = proposer.propose(seen(T), seen(np.eye(4)), watch)
    assert off_m(proposed[0]) < 0.06  # a cell of the grid on which keypoints are
    assert off_m(proposed[1]) < 1e-6  # centroids are exact
    assert {"description", "matching", "verification"} <= set(watch.timings_ms())


def test_descriptors_are_the_same_from_every_side_and_histograms_of_a_hundred() -> None:
    here, there = (describe(seen(frame).segments, 0.06, 0.15, 0.5) for frame in (np.eye(4), T))
    assert len(here.points) > 10
    assert here.descriptors.shape == (len(here.points), 33)
    # Each neighbour's three histograms sum to a hundred, and so do those of the point itself.
    assert here.descriptors.reshape(-1, 3, 11).sum(axis=2) == pytest.approx(200, rel=1e-6)
    near = np.linalg.norm(transform(T, here.points)[:, None] - there.points, axis=2)
    # Grids of both frames cut the lumps elsewhere: keypoints are a cell apart, or lost.
    assert np.median(near.min(axis=1)) < 0.1


def test_nothing_is_described_where_nothing_stands_out() -> None:
    flat = np.array([[x, y, 0.0] for x in range(3) for y in range(3)]) * 0.05
    for segments in ((), (Segment(0, flat, flat.mean(axis=0), np.ones(3)),)):
        found = describe(segments, 0.04, 0.15, 0.5)
        assert found.points.shape == (0, 3)
        assert found.descriptors.shape == (0, 33)


def test_kiss_matcher_proposes_one_motion() -> None:
    pytest.importorskip("kiss_matcher")
    watch, proposer, cores = Stopwatch(), FasterPfh(0.1), os.sched_getaffinity(0)
    (found,) = proposer.propose(seen(T), seen(np.eye(4)), watch)
    assert off_m(found) < 0.05
    assert np.linalg.det(found[:3, :3]) == pytest.approx(1, abs=1e-12)
    assert {"matching", "verification"} <= set(watch.timings_ms())
    assert os.sched_getaffinity(0) == cores


def test_what_kiss_matcher_does_not_vouch_for_is_not_proposed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Matcher:
        """Finds nothing."""

        def __init__(self, voxel_m: float) -> None:
            assert voxel_m == 0.1

        def match(self, here: list[Float], there: list[Float]) -> tuple[int, int]:
            return len(here), len(there)

        def prune_and_solve(self, here: int, there: int) -> SimpleNamespace:
            assert (here, there) == (4500, 1500)
            return SimpleNamespace(valid=False)

    monkeypatch.setattr(kiss_matcher, "_package", lambda: SimpleNamespace(KISSMatcher=Matcher))
    whole = seen(T)
    one = replace(whole, segments=whole.segments[:1])
    assert FasterPfh(0.1).propose(one, whole, Stopwatch()) == []


def test_open3d_is_imported_before_the_first_registration(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "executive_plugins.registration.fpfh_features"
    monkeypatch.delitem(sys.modules, name)
    load_open3d()
    assert name in sys.modules


@pytest.mark.parametrize(
    ("plugin", "settings", "extra"),
    [(SegmentFpfh, SegmentFpfhSettings, "fpfh"), (KissMatcher, KissMatcherSettings, "kiss")],
)
def test_what_describes_is_looked_for_before_the_robot_starts(
    plugin: type[SegmentFpfh] | type[KissMatcher],
    settings: type,
    extra: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    made = plugin(settings(), segmentation, Gicp(GicpSettings()))
    (proposer,) = made._proposers()
    assert isinstance(proposer, FpfhAndConstellation | FasterPfh)
    missing = {"fpfh": "open3d", "kiss": "kiss-matcher"}[extra]
    monkeypatch.setattr("executive.extras._is_installed", lambda name: name != missing)
    with pytest.raises(ConfigError, match=rf"executive\[{extra}\]"):
        made.start()
