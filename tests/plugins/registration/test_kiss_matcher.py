"""Registration by KISS-Matcher, behind the gate of the others."""

import os
from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.registration.kiss_matcher import KissMatcher, _one_core, _orthonormal
from executive_plugins.registration.settings import KissMatcherSettings
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.errors import ConfigError
from executive.geometry.rotation import exp_so3
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


def plugin() -> KissMatcher:
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    return KissMatcher(KissMatcherSettings(), segmentation, Gicp(GicpSettings()))


def register(target: Cloud, source: Cloud) -> Alignment:
    pytest.importorskip("kiss_matcher")
    return plugin().register(target, source, np.random.default_rng(0))


def test_a_survey_is_laid_over_the_map(make_scene: Callable) -> None:
    scene = make_scene(100, rays=120_000)
    found = register(scene.target, scene.source)
    assert found.accepted, found.reason
    assert scene.errors(found.apply)[1] < 0.05
    assert found.scale == pytest.approx(1 / scene.stretch, abs=0.003)


def test_a_survey_of_another_site_is_refused(make_scene: Callable) -> None:
    scene = make_scene(300, rays=120_000, survey_seed=1300)
    assert not register(scene.target, scene.source).accepted


def test_a_missing_package_is_named_before_the_robot_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("executive.extras._is_installed", lambda name: name != "kiss-matcher")
    with pytest.raises(ConfigError, match="pip install"):
        plugin().start()


def test_what_the_package_does_happens_on_one_core_and_all_are_free_again() -> None:
    """Also when it fails, and also where one core is all that there is."""
    allowed, inside = os.sched_getaffinity(0), set[int]()

    def call() -> None:
        with _one_core():
            inside.update(os.sched_getaffinity(0))
            raise ValueError("of the package")

    with pytest.raises(ValueError, match="of the package"):
        call()
    assert len(inside) == 1
    assert inside <= allowed
    assert os.sched_getaffinity(0) == allowed


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_rotation_of_single_precision_becomes_one(sign: float) -> None:
    R = exp_so3(np.array([0.3, -1.2, 0.8]))
    rough = sign * (R + np.random.default_rng(0).normal(0, 1e-6, (3, 3)))
    found = _orthonormal(rough)
    np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(found) > 0  # also of a reflection
    if sign > 0:
        np.testing.assert_allclose(found, R, atol=1e-5)


def test_of_a_reflection_the_nearest_rotation_is_taken() -> None:
    R = exp_so3(np.array([0.3, -1.2, 0.8]))
    np.testing.assert_allclose(
        _orthonormal(R @ np.diag([1.1, 1.0, -0.5]) @ R.T), np.eye(3), atol=1e-12
    )
