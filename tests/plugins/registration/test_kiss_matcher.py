"""Registration by KISS-Matcher, behind the gate of the others."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.registration.kiss_matcher import KissMatcher
from executive_plugins.registration.settings import KissMatcherSettings
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.errors import ConfigError
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
