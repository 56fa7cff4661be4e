"""The course of a training with networks of one number, and the data card."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from executive_plugins.grasping.classifier.grasp_features import NUMBERS
from executive_plugins.grasping.classifier.grasp_images import CHANNELS, PIXELS, mirrored
from executive_plugins.grasping.classifier.outcome_net import FourLayer, TwoStream, save_net
from executive_plugins.grasping.learning import grasp_training, training
from executive_plugins.grasping.learning.grasp_training import train_weights
from executive_plugins.grasping.learning.label_work import GraspLabels
from executive_plugins.grasping.learning.labels import Labels, LabelSettings
from executive_plugins.grasping.learning.training import (
    Progress,
    TrainingSettings,
    area_under_curve,
    predictions,
    split_by_stone,
    train,
    untrained,
)

from executive.config import NoSettings
from executive.errors import ConfigError
from executive.interfaces.work import Piece


class OneNumber(torch.nn.Module):
    """Predicts the same logit for all, and keeps what it is shown while it learns."""

    def __init__(self, logit: float) -> None:
        super().__init__()
        self.logit = torch.nn.Parameter(torch.tensor(logit))
        self.shown: list[tuple[np.ndarray, np.ndarray]] = []

    def forward(self, images: torch.Tensor, numbers: torch.Tensor) -> torch.Tensor:
        if self.training:
            self.shown.append((images.numpy().copy(), numbers.numpy().copy()))
        return self.logit.expand(len(images))


def labels(count: int, seed: int = 0) -> Labels:
    rng = np.random.default_rng(seed)
    images = rng.integers(0, 256, (count, CHANNELS, PIXELS, PIXELS)).astype(np.uint8)
    numbers = rng.normal(3.0, 2.0, (count, len(NUMBERS))).astype(np.float32)
    return Labels(images, numbers, np.arange(count) % 5 < 2, np.arange(count) // 3)


def test_each_epoch_shows_all_labels_once_in_batches_of_nearly_one_size() -> None:
    net, learned = OneNumber(0.5), labels(10)
    settings = TrainingSettings(epochs=2, batch=4, rate=1e-9)
    told = list(train(net, learned, labels(6, 1), settings))
    assert [len(numbers) for _, numbers in net.shown] == [4, 3, 3] * 2
    orders = []
    for epoch in (net.shown[:3], net.shown[3:]):
        rows = np.vstack([numbers for _, numbers in epoch])
        orders.append(
            [int(np.flatnonzero((learned.numbers == row).all(axis=1))[0]) for row in rows]
        )
        assert sorted(orders[-1]) == list(range(10))
    assert orders[0] != orders[1]
    # Both classes cost what the logit says; the loss is the mean over batches.
    cost = np.where(learned.is_lifted, np.log1p(np.exp(-0.5)), np.log1p(np.exp(0.5)))
    for progress, order in zip(told, orders, strict=True):
        batches = np.array_split(cost[order], 3)
        assert progress.loss == pytest.approx(np.mean([one.mean() for one in batches]), rel=1e-5)
    # All predictions are alike: half of the pairs count.
    assert [(one.epoch, one.auc) for one in told] == [(1, 0.5), (2, 0.5)]
    again = OneNumber(0.5)
    list(train(again, learned, labels(6, 1), settings))
    assert all(np.array_equal(a[0], b[0]) for a, b in zip(net.shown, again.shown, strict=True))


def test_pictures_are_mirrored_half_of_the_time_in_each_plane() -> None:
    learned = labels(200)
    net = OneNumber(0.0)
    list(train(net, learned, learned, TrainingSettings(epochs=1, batch=200)))
    ((images, numbers),) = net.shown
    counts = np.zeros((2, 2), dtype=int)
    for image, row in zip(images, numbers, strict=True):
        i = int(np.flatnonzero((learned.numbers == row).all(axis=1))[0])
        given = learned.images[i : i + 1].astype(np.float32) / 255
        for a in (0, 1):
            for b in (0, 1):
                as_shown = mirrored(given, 1) if a else given
                as_shown = mirrored(as_shown, 2) if b else as_shown
                counts[a, b] += np.array_equal(image, as_shown[0])
    assert counts.sum() == 200
    assert (counts > 30).all()  # fifty each, give or take three standard deviations


def test_the_rate_falls_along_half_a_cosine_to_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    rates, made = [], []

    class Watched(torch.optim.AdamW):
        def __init__(self, parameters, **given) -> None:
            made.append(given)
            super().__init__(parameters, **given)

        def step(self, closure=None):
            rates.append(self.param_groups[0]["lr"])
            return super().step(closure)

    monkeypatch.setattr(training.torch.optim, "AdamW", Watched)
    settings = TrainingSettings(epochs=2, batch=3, rate=0.02, decay=0.01)
    net = OneNumber(0.0)
    list(train(net, labels(6), labels(6), settings))
    assert made == [{"lr": 0.02, "weight_decay": 0.01}]
    expected = [0.01 * (1 + np.cos(np.pi * k / 4)) for k in range(4)]
    assert rates == pytest.approx(expected)
    assert float(net.logit.detach()) < 0.0  # two in five are lifted


def test_the_stream_of_numbers_is_scaled_by_what_is_learned_from() -> None:
    learned = labels(8)
    settings = TrainingSettings(epochs=1, batch=8)
    net = untrained(settings)
    assert isinstance(net, TwoStream)
    list(train(net, learned, learned, settings))
    assert net.mean.numpy() == pytest.approx(learned.numbers.mean(axis=0))
    assert net.spread.numpy() == pytest.approx(learned.numbers.std(axis=0) + 1e-6)


def test_initial_weights_follow_from_the_seed() -> None:
    for name, kind in (("two_stream", TwoStream), ("four_layer", FourLayer)):
        first, again, other = (
            untrained(TrainingSettings(architecture=name, seed=seed)) for seed in (4, 4, 5)
        )
        assert isinstance(first, kind)
        weights = [next(net.parameters()).detach().numpy() for net in (first, again, other)]
        assert np.array_equal(weights[0], weights[1])
        assert not np.array_equal(weights[0], weights[2])


def test_a_training_that_goes_on_keeps_weights_and_scale_of_numbers(tmp_path: Path) -> None:
    learned, path = labels(8), tmp_path / "before.safetensors"
    before = untrained(TrainingSettings(seed=4))
    assert isinstance(before, TwoStream)
    before.mean.fill_(7.0)
    save_net(before, path, "{}")
    settings = TrainingSettings(start=str(path), epochs=1, batch=8, rate=1e-9)
    net = untrained(settings)
    for name, values in net.state_dict().items():
        assert np.array_equal(values.numpy(), before.state_dict()[name].numpy()), name
    list(train(net, learned, learned, settings))
    assert np.array_equal(net.mean.numpy(), np.full(len(NUMBERS), 7.0, dtype=np.float32))
    with pytest.raises(ConfigError, match="no weights of the four_layer"):
        untrained(TrainingSettings(start=str(path), architecture="four_layer"))


def test_predictions_are_of_pictures_from_0_to_1() -> None:
    given, found = labels(5), []

    class Brightness(torch.nn.Module):
        def forward(self, images: torch.Tensor, numbers: torch.Tensor) -> torch.Tensor:
            found.append(float(images.max()))
            return numbers[:, 0] - 3.0

    score, is_lifted = predictions(Brightness(), given)
    assert max(found) == pytest.approx(given.images.max() / 255)
    assert score == pytest.approx(1 / (1 + np.exp(3.0 - given.numbers[:, 0])), abs=6e-4)
    assert np.array_equal(is_lifted, given.is_lifted)


def test_a_share_of_the_stones_is_held_out_rounded_up() -> None:
    given = labels(30)  # ten stones
    for held_out, expected in ((0.2, 2), (0.21, 3), (0.01, 1)):
        learned, validation = split_by_stone(given, held_out, np.random.default_rng(0))
        assert len(set(validation.stone)) == expected
        assert len(validation.numbers) == 3 * expected
        both = np.concatenate([learned.numbers, validation.numbers])
        assert len(np.unique(both, axis=0)) == 30


def test_the_area_is_nothing_known_without_both_outcomes() -> None:
    score = np.array([0.1, 0.9, 0.5])
    assert np.isnan(area_under_curve(score, np.zeros(3, dtype=bool)))
    assert np.isnan(area_under_curve(score, np.ones(3, dtype=bool)))
    assert area_under_curve(score, np.array([False, True, False])) == 1.0
    assert area_under_curve(score, np.array([True, False, False])) == 0.0


@pytest.mark.parametrize("is_tested", [False, True])
def test_the_card_tells_what_was_learned_and_how_well(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, is_tested: bool
) -> None:
    folders = {tmp_path / "own": labels(30), tmp_path / "other": labels(9, 2)}
    saved, told = [], []
    progress = [Progress(1, 0.7, 0.5), Progress(2, 0.6, 0.6)]
    monkeypatch.setattr(grasp_training, "read_labels", folders.__getitem__)
    monkeypatch.setattr(grasp_training, "read_description", lambda folder: {"at": folder.name})
    monkeypatch.setattr(grasp_training, "train", lambda *given: iter(progress))
    monkeypatch.setattr(grasp_training, "untrained", lambda settings: "net")
    monkeypatch.setattr(grasp_training, "save_net", lambda *given: saved.append(given))
    scores = {9: 0.123456, 6: 0.65432}  # by the number of labels: those of the test, and held out
    monkeypatch.setattr(grasp_training, "predictions", lambda net, own: (len(own.numbers),))
    monkeypatch.setattr(grasp_training, "area_under_curve", scores.__getitem__)
    settings = TrainingSettings(held_out=0.2, seed=3)
    out = tmp_path / "new" / "folders" / "weights.safetensors"
    test_folder = tmp_path / "other" if is_tested else None
    card = train_weights(tmp_path / "own", out, settings, test_folder, told.append)
    learned, validation = split_by_stone(labels(30), 0.2, np.random.default_rng(3))
    expected = {
        "labels": {"at": "own"},
        "lifted_when_slip_below_m": grasp_training.LIFTED_M,
        "training": settings.model_dump(mode="json"),
        "learned": {
            "stones": 8,
            "grasps": 24,
            "lifted": round(float(learned.is_lifted.mean()), 3),
        },
        "validation": {
            "stones": 2,
            "grasps": 6,
            "lifted": round(float(validation.is_lifted.mean()), 3),
            "auc": 0.6543,
        },
    }
    if is_tested:
        expected["test_labels"] = {"at": "other"}
        expected["test"] = {"stones": 3, "grasps": 9, "lifted": 0.444, "auc": 0.1235}
    assert card == expected
    assert told == progress
    assert out.parent.is_dir()
    assert saved == [("net", out, json.dumps(expected, indent=2))]


def test_a_machine_that_is_brought_takes_the_place_of_the_one_that_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    labelled, sampled = [], []
    module = "executive_plugins.grasping.learning.label_work"
    monkeypatch.setattr(f"{module}.label_stone", lambda *given: labelled.append(given))
    monkeypatch.setattr(f"{module}.sampler_of", sampled.append)
    named = LabelSettings(machine="mine")
    work, brought = GraspLabels(), {"machine": tmp_path / "copy"}
    work.prepare(named, brought)
    work.prepare(named, {})
    assert sampled == [str(tmp_path / "copy"), "mine"]
    assert work.run(Piece(named, 7, tmp_path, brought)) == {"file": "stone_00007.npz"}
    ((folder, settings, number),) = labelled
    assert (folder, number) == (tmp_path, 7)
    assert settings == named.model_copy(update={"machine": str(tmp_path / "copy")})
    with pytest.raises(TypeError, match="expected LabelSettings, got NoSettings"):
        work.inputs(NoSettings())
