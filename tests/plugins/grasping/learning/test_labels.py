"""Labels: the same from a seed however they are made, split by stone, and worth learning from."""

import json
from pathlib import Path

import numpy as np
import pytest
from executive_plugins.grasping.classifier.grasp_features import NUMBERS
from executive_plugins.grasping.classifier.grasp_images import CHANNELS, PIXELS
from executive_plugins.grasping.classifier.outcome_net import load_net, save_net
from executive_plugins.grasping.learning.grasp_training import train_weights
from executive_plugins.grasping.learning.label_work import GraspLabels
from executive_plugins.grasping.learning.labels import (
    Labels,
    LabelSettings,
    claim,
    label_stone,
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
from executive.interfaces.work import Piece

FEW = LabelSettings(grasps_per_stone=4)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("labels")
    claim(path, FEW)
    for index in range(2):
        label_stone(path, FEW, index)
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


def test_a_stone_follows_from_the_seed_and_its_number_alone(folder: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    answer = GraspLabels().run(Piece(FEW, 1, run, {}))
    assert answer == {"file": "stone_00001.npz"}
    assert (run / "stone_00001.npz").read_bytes() == (folder / "stone_00001.npz").read_bytes()


def test_a_machine_of_ones_own_is_an_input(tmp_path: Path) -> None:
    machine = tmp_path / "machine"
    machine.mkdir()
    own = LabelSettings(machine=str(machine))
    assert GraspLabels().inputs(own) == {"machine": machine}
    assert GraspLabels().inputs(FEW) == {}


def test_weights_of_ones_own_are_an_input_and_their_copy_is_read(tmp_path: Path) -> None:
    mine, copy = tmp_path / "mine.safetensors", tmp_path / "copy.safetensors"
    save_net(untrained(TrainingSettings()), copy, "{}")
    mine.write_bytes(b"no weights")  # on another computer nothing is at this path
    own = LabelSettings(grasps_per_stone=3, weights=str(mine))
    assert GraspLabels().inputs(own) == {"weights": mine}
    assert GraspLabels().inputs(LabelSettings(weights="two_stream")) == {}
    run = tmp_path / "run"
    run.mkdir()
    GraspLabels().run(Piece(own, 0, run, {"weights": copy}))
    assert len(read_labels(run).stone) == 3


def test_labels_of_other_settings_do_not_mix(folder: Path) -> None:
    with pytest.raises(ConfigError, match="settings other than"):
        claim(folder, LabelSettings(grasps_per_stone=4, seed=2))


def test_labels_from_before_a_setting_existed_have_its_default(tmp_path: Path) -> None:
    described = FEW.model_dump(mode="json", exclude={"physics"})
    (tmp_path / "labels.json").write_text(json.dumps(described))
    claim(tmp_path, FEW)
    with pytest.raises(ConfigError, match="settings other than"):
        claim(tmp_path, FEW.model_copy(update={"physics": "wet"}))


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
