"""The networks: what they are told to ignore, what their files may hold, and half turns."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from executive_plugins.grasping.classifier.grasp_features import NUMBERS, GraspFeatures
from executive_plugins.grasping.classifier.grasp_images import CHANNELS, PIXELS, mirrored
from executive_plugins.grasping.classifier.outcome_net import (
    Architecture,
    load_net,
    new_net,
    save_net,
    success,
)
from executive_plugins.grasping.classifier.weights_file import weights_file
from executive_plugins.grasping.settings import SampledCnnSettings
from executive_plugins.physics.belief import belief_of
from safetensors import safe_open
from safetensors.torch import save_file

from executive.errors import DataError
from executive.machine.machine import load_machine

BOTH: list[Architecture] = ["four_layer", "two_stream"]


def shown(n: int = 5) -> GraspFeatures:
    rng = np.random.default_rng(0)
    images = rng.random((n, CHANNELS, PIXELS, PIXELS), dtype=np.float32)
    return GraspFeatures(images, rng.random((n, len(NUMBERS)), dtype=np.float32))


@pytest.mark.parametrize("architecture", BOTH)
def test_a_file_gives_back_the_network(architecture: Architecture, tmp_path: Path) -> None:
    torch.manual_seed(0)
    net = new_net(architecture)
    save_net(net, tmp_path / "net.safetensors", "{}")
    loaded = load_net(tmp_path / "net.safetensors")
    assert type(loaded) is type(net)
    np.testing.assert_array_equal(success(loaded, shown()), success(net, shown()))


@pytest.mark.parametrize("architecture", BOTH)
def test_half_a_turn_about_the_approach_changes_no_prediction(architecture: Architecture) -> None:
    torch.manual_seed(0)
    net, evidence = new_net(architecture), shown()
    turned = GraspFeatures(mirrored(mirrored(evidence.images, 1), 2), evidence.numbers)
    np.testing.assert_allclose(success(net, evidence), success(net, turned), atol=2e-3)


def test_a_prediction_does_not_depend_on_the_grasps_beside_it() -> None:
    net, evidence = load_net(weights_file("two_stream")), shown(300)
    alone = success(net, GraspFeatures(evidence.images[290:], evidence.numbers[290:]))
    np.testing.assert_allclose(alone, success(net, evidence)[290:], atol=2e-3)


def test_no_grasps_have_no_predictions() -> None:
    assert success(new_net("two_stream"), shown(0)).shape == (0,)


@pytest.mark.parametrize("content", [b"", b"\x80\x04K\x01.", b"not weights"])
def test_a_file_that_holds_no_tensors_is_refused_by_name(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "net.safetensors"
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"net\.safetensors: cannot read weights"):
        load_net(path)


def test_a_missing_file_is_refused_with_the_cure(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="grasp-train"):
        load_net(tmp_path / "none.safetensors")


def test_tensors_of_something_else_are_refused(tmp_path: Path) -> None:
    save_file({"a": torch.zeros(2)}, tmp_path / "a.safetensors")
    with pytest.raises(DataError, match="no weights of a grasp classifier"):
        load_net(tmp_path / "a.safetensors")
    metadata = {"format": "executive.grasp_outcome.v1", "architecture": "four_layer"}
    save_file({"a": torch.zeros(2)}, tmp_path / "a.safetensors", metadata=metadata)
    with pytest.raises(DataError, match="do not fit"):
        load_net(tmp_path / "a.safetensors")


@pytest.mark.parametrize("architecture", BOTH)
def test_shipped_weights_are_small(architecture: Architecture) -> None:
    path = weights_file(architecture)
    assert type(load_net(path)) is type(new_net(architecture))
    assert path.stat().st_size < 10e6


def test_the_card_of_the_default_weights_tells_lifts_like_those_of_a_mission() -> None:
    """A prediction is a probability only for lifts like those that it has learned from."""
    assumed = SampledCnnSettings()
    with safe_open(weights_file(assumed.weights), framework="pt") as file:
        card = json.loads(file.metadata()["card"])
    labels = card["labels"]
    gripper = load_machine("m545").gripper
    assert labels["physics"] == belief_of(assumed.physics, gripper).scenario == "nominal"
    assert labels["arm_error_m"] == assumed.arm_error_m
    assert labels["arm_error_rad"] == pytest.approx(assumed.arm_error_rad, rel=0.01)
    assert (labels["seed"], labels["weights"]) == (16, "two_stream_kind")
    assert card["training"]["start"] == "two_stream_kind"
    assert card["learned"] == {"stones": 290, "grasps": 6960, "lifted": 0.43}
