"""One stone found again however it lies, from what lidars see of it; nothing that is not it."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.registration.segment_fpfh import SegmentFpfh
from executive_plugins.registration.segment_shot import SegmentShot
from executive_plugins.registration.settings import SegmentFpfhSettings, SegmentShotSettings
from executive_plugins.registration.single_object import _rotations
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import angle_between, exp_so3
from executive.geometry.voxels import voxel_means
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment

SEGMENTER = GroundAndClusters(GroundAndClustersSettings())
SHOT = SegmentShot(SegmentShotSettings(), SEGMENTER, Gicp(GicpSettings()))
FPFH = SegmentFpfh(SegmentFpfhSettings(), SEGMENTER, Gicp(GicpSettings()))


@pytest.fixture(scope="module")
def site(make_scene: Callable) -> tuple[np.ndarray, tuple[Segment, ...]]:
    """Return a lidar map, and the stones as map and survey together show them."""
    scene = make_scene(31, rays=120_000)
    survey = transform(scene.T_target_source, scene.source.points)
    survey = scene.centre + (survey - scene.centre) / scene.stretch
    whole = voxel_means(np.vstack([scene.target.points, survey]), 0.03)
    return scene.target.points, SEGMENTER.segment(Cloud("map", whole)).segments


def around(points: np.ndarray, stone: Segment, radius_m: float = 1.8) -> Cloud:
    return Cloud(
        "map", points[np.linalg.norm(points[:, :2] - stone.centroid[:2], axis=1) < radius_m]
    )


def tumbled(seed: int) -> np.ndarray:
    """A motion far beyond any basin of ICP."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    return pose(exp_so3(axis / np.linalg.norm(axis) * rng.uniform(0.8, 3.1)), rng.uniform(-3, 3, 3))


@pytest.mark.parametrize(("registrar", "number"), [(SHOT, 0), (SHOT, 1), (SHOT, 2), (FPFH, 3)])
def test_a_stone_that_tumbled_is_found(site: tuple, registrar: SegmentShot, number: int) -> None:
    points, stones = site
    stone, T = stones[number], tumbled(number)
    found = registrar.find(around(points, stone), Cloud("map", transform(T, stone.points)))
    assert found.accepted, found.reason
    left = found.T_target_source @ T
    # 3 cm, 2°: the survey is warped by 1.2 cm, a stone is a metre long.
    assert np.linalg.norm(transform(left, stone.centroid) - stone.centroid) < 0.03
    assert angle_between(left[:3, :3], np.eye(3)) < np.radians(2.0)


def test_the_same_clouds_give_the_same_bits(site: tuple) -> None:
    points, stones = site
    clouds = around(points, stones[0]), Cloud("map", transform(tumbled(1), stones[0].points))
    first, second = SHOT.find(*clouds), SHOT.find(*clouds)
    np.testing.assert_array_equal(first.T_target_source, second.T_target_source)


@pytest.mark.parametrize("number", range(3))
def test_another_stone_is_not_it(site: tuple, number: int) -> None:
    points, stones = site
    found = SHOT.find(
        around(points, stones[number]),
        Cloud("map", transform(tumbled(2), stones[number + 1].points)),
    )
    assert not found.accepted
    assert found.reason


def test_a_ball_lies_every_way_and_is_refused() -> None:
    rng = np.random.default_rng(0)
    d = rng.normal(size=(6000, 3))
    ball = 0.5 * d / np.linalg.norm(d, axis=1)[:, None]
    ground = np.column_stack([rng.uniform(-2, 2, (20_000, 2)), rng.normal(0, 0.005, 20_000)])
    site = np.vstack([ground, ball[ball[:, 2] > -0.2] + [0, 0, 0.45]])
    found = SHOT.find(Cloud("map", site), Cloud("map", transform(tumbled(0), ball)))
    assert not found.accepted
    assert "it may as well lie otherwise" in found.reason


def test_bare_ground_holds_nothing() -> None:
    rng = np.random.default_rng(0)
    ground = np.column_stack([rng.uniform(-2, 2, (20_000, 2)), rng.normal(0, 0.005, 20_000)])
    found = SHOT.find(Cloud("map", ground), Cloud("map", rng.uniform(-0.5, 0.5, (900, 3))))
    assert not found.accepted
    assert "nothing of the object's size" in found.reason
    assert not SHOT.find(
        Cloud("map", ground[:5]), Cloud("map", rng.uniform(-0.5, 0.5, (900, 3)))
    ).accepted


def test_no_turn_is_far_from_those_that_are_tried() -> None:
    tried = list(_rotations(240))
    rng = np.random.default_rng(0)
    drawn = [
        exp_so3(axis / np.linalg.norm(axis) * rng.uniform(0, np.pi))
        for axis in rng.normal(size=(100, 3))
    ]
    assert max(min(angle_between(R, turn) for turn in tried) for R in drawn) < np.radians(40)


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.full((4, 3), 2.0)])
def test_a_model_without_extent_is_not_searched_for(points: np.ndarray) -> None:
    found = SHOT.find(Cloud("map", np.zeros((0, 3))), Cloud("map", points))
    assert not found.accepted
    assert "no extent" in found.reason


def test_a_cloud_without_ground_is_told() -> None:
    model = Cloud("map", np.random.default_rng(0).uniform(-0.5, 0.5, (100, 3)))
    found = SHOT.find(Cloud("map", np.zeros((0, 3))), model)
    assert not found.accepted
    assert "cannot be segmented" in found.reason
