"""Registration by SHOT, on scenes with truth; its figures are in
tests/benchmarks/perception_figures.py.
"""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.registration.segment_shot import SegmentShot
from executive_plugins.registration.settings import SegmentShotSettings
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from pydantic import ValidationError

from executive.geometry.rotation import angle_between
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


def register(target: Cloud, source: Cloud, **settings: object) -> Alignment:
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    registrar = SegmentShot(
        SegmentShotSettings.model_validate(settings), segmentation, Gicp(GicpSettings())
    )
    registrar.start()
    return registrar.register(target, source, np.random.default_rng(0))


@pytest.mark.parametrize(("seed", "rays"), [(100, 250_000), (200, 60_000)])
def test_shot_alone_lays_a_survey_over_the_map(make_scene: Callable, seed: int, rays: int) -> None:
    scene = make_scene(seed, rays=rays)
    found = register(scene.target, scene.source, falls_back=False)
    assert found.accepted, found.reason
    assert scene.errors(found.apply)[1] < 0.05
    assert angle_between(found.T_target_source[:3, :3], scene.T_target_source[:3, :3]) < np.radians(
        1.0
    )
    assert found.scale == pytest.approx(1 / scene.stretch, abs=0.003)
    stages = {
        "segmentation",
        "keypoints",
        "description",
        "matching",
        "verification",
        "refinement",
        "gate",
        "rivals",
        "total",
    }
    assert set(found.timings_ms) == stages


@pytest.mark.parametrize("stretch", [0.97, 1.03])
def test_a_scale_wrong_by_three_percent_is_found(make_scene: Callable, stretch: float) -> None:
    scene = make_scene(102, rays=120_000, stretch=stretch)
    found = register(scene.target, scene.source)
    assert found.accepted, found.reason
    assert found.scale == pytest.approx(1 / stretch, abs=0.003)


def test_a_survey_of_another_site_is_refused(make_scene: Callable) -> None:
    scene = make_scene(300, rays=120_000, survey_seed=1300)
    found = register(scene.target, scene.source)
    assert not found.accepted
    assert found.reason
    assert "description" in found.timings_ms


def test_where_shot_fails_constellations_find_it(make_scene: Callable) -> None:
    scene = make_scene(101, rays=120_000)
    blind = {
        "shot_radius_m": 0.051,
        "feature_voxel_m": 0.05,
    }  # no keypoint has enough points around it
    assert not register(scene.target, scene.source, falls_back=False, **blind).accepted
    found = register(scene.target, scene.source, **blind)
    assert found.accepted, found.reason
    assert scene.errors(found.apply)[1] < 0.05


def test_national_coordinates_keep_their_digits(make_scene: Callable) -> None:
    scene = make_scene(100, rays=120_000)
    near = register(scene.target, scene.source)
    utm = np.array([465_000.0, 5_250_000.0, 440.0])
    far = register(
        Cloud("map", scene.target.points + utm), Cloud("survey", scene.source.points + utm)
    )
    assert far.accepted, far.reason
    moved = far.apply(scene.source.points[::100] + utm) - utm
    np.testing.assert_allclose(
        moved, near.apply(scene.source.points[::100]), atol=0.005
    )  # another voxel grid


def test_the_same_clouds_give_the_same_bits(make_scene: Callable) -> None:
    scene = make_scene(200, rays=60_000)
    a, b = (register(scene.target, scene.source) for _ in range(2))
    np.testing.assert_array_equal(a.T_target_source, b.T_target_source)
    assert (a.scale, a.rmse_m, a.overlap) == (b.scale, b.rmse_m, b.overlap)


def test_the_papers_radii_are_a_preset_that_single_radii_override() -> None:
    paper = SegmentShotSettings.model_validate({"preset": "paper", "iss_radius_m": "8 cm"})
    assert (paper.iss_radius_m, paper.shot_radius_m) == (0.08, 0.10)
    assert SegmentShotSettings() == SegmentShotSettings.model_validate({"preset": "sure"})
    with pytest.raises(ValidationError, match="'sure' or 'paper'"):
        SegmentShotSettings.model_validate({"preset": "papper"})
