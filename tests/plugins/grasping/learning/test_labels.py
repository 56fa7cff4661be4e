"""Labels: the same from a seed however they are made, split by stone, and worth learning from."""

from pathlib import Path

import numpy as np
import pytest
from executive_plugins.grasping.classifier.grasp_features import NUMBERS
from executive_plugins.grasping.classifier.grasp_images import CHANNELS, PIXELS
from executive_plugins.grasping.classifier.outcome_net import load_net
from executive_plugins.grasping.learning.grasp_training import train_weights
from executive_plugins.grasping.learning.labels import (
    Labels,
    LabelSettings,
    make_labels,
    read_labels,
)
from executive_plugins.grasping.learning.training import (
    TrainingSettings,
    area_under_curve,
    predictions,
    split_by_stone,
    train,
    untrained,
)

from executive.errors import ConfigError, DataError

FEW = LabelSettings(grasps_per_stone=4)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("labels")
    assert list(make_labels(path, 2, FEW)) == [0, 1, 2]
    return path


def learnable(stones: int = 40) -> Labels:
    """Return labels whose outcome is the sign of one cost."""
    rng = np.random.default_rng(0)
    numbers = rng.normal(size=(stones * 6, len(NUMBERS))).astype(np.float32)
    images = np.zeros((len(numbers), CHANNELS, PIXELS, PIXELS), dtype=np.uint8)
    return Labels(images, numbers, numbers[:, 0] > 0, np.repeat(np.arange(stones), 6))


def test_labels_hold_images_numbers_and_outcomes_of_each_stone(folder: Path) -> None:
    labels = read_labels(folder)
    assert labels.images.shape == (8, CHANNELS, PIXELS, PIXELS)
    assert labels.images.any(axis=(1, 2, 3)).all()
    assert np.isfinite(labels.numbers).all()
    assert labels.stone.tolist() == [0] * 4 + [1] * 4


def test_what_is_missing_is_made_again_and_the_same(folder: Path) -> None:
    before = read_labels(folder)
    (folder / "stone_00001.npz").unlink()
    assert list(make_labels(folder, 2, FEW)) == [1, 2]
    np.testing.assert_array_equal(read_labels(folder).images, before.images)
    np.testing.assert_array_equal(read_labels(folder).is_lifted, before.is_lifted)


def test_labels_of_other_settings_do_not_mix(folder: Path) -> None:
    with pytest.raises(ConfigError, match="settings other than"):
        list(make_labels(folder, 2, LabelSettings(grasps_per_stone=4, seed=2)))


def test_a_folder_without_labels_is_refused_with_the_cure(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="grasp-data"):
        read_labels(tmp_path)


def test_no_stone_is_on_both_sides_of_the_split() -> None:
    learned, validation = split_by_stone(learnable(), 0.2, np.random.default_rng(0))
    assert not set(learned.stone) & set(validation.stone)
    assert len(set(validation.stone)) == 8
    assert len(learned.stone) + len(validation.stone) == 240


def test_the_area_under_the_curve_is_the_chance_to_order_a_pair_rightly() -> None:
    score, lifted = np.array([0.1, 0.4, 0.4, 0.8, 0.3]), np.array([False, True, False, True, False])
    pairs = [(p > n) + (p == n) / 2 for p in score[lifted] for n in score[~lifted]]
    assert area_under_curve(score, lifted) == pytest.approx(np.mean(pairs))
    assert np.isnan(area_under_curve(score, np.ones(5, bool)))


def test_training_learns_what_the_costs_say_and_one_seed_gives_one_network() -> None:
    settings = TrainingSettings(epochs=4, rate=5e-3, batch=32)
    learned, validation = split_by_stone(learnable(40), 0.2, np.random.default_rng(0))
    nets = [untrained(settings) for _ in range(2)]
    for net in nets:
        *_, last = train(net, learned, validation, settings)
        assert last.auc > 0.8
    np.testing.assert_array_equal(*(predictions(net, validation)[0] for net in nets))


def test_the_data_card_counts_what_the_weights_have_learned_from(
    folder: Path, tmp_path: Path
) -> None:
    settings = TrainingSettings(epochs=1, held_out=0.5, batch=4)
    card = train_weights(folder, tmp_path / "net.safetensors", settings, test_folder=folder)
    assert card["labels"] == FEW.model_dump(mode="json")
    assert card["learned"]["stones"] == card["validation"]["stones"] == 1
    assert card["test"]["grasps"] == 8
    load_net(tmp_path / "net.safetensors")
