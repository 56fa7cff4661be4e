"""Train a network on labels and write its weights with a data card."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from executive_plugins.grasping.classifier.outcome_net import FourLayer, TwoStream, save_net
from executive_plugins.grasping.learning.labels import Labels, read_description, read_labels
from executive_plugins.grasping.learning.training import (
    Progress,
    TrainingSettings,
    area_under_curve,
    predictions,
    split_by_stone,
    train,
    untrained,
)
from executive_plugins.grasping.simulated_lift import LIFTED_M


def train_weights(
    folder: Path,
    out: Path,
    settings: TrainingSettings,
    test_folder: Path | None = None,
    after_epoch: Callable[[Progress], None] = lambda _: None,
) -> dict[str, object]:
    """Train on a folder of labels, write a safetensors file, and return its data card.

    Args:
        folder: Labels; a share of their stones is held out for validation.
        out: File to write.
        settings: How to train.
        test_folder: Labels of other stones, used once, after training.
        after_epoch: Called with the progress after each epoch.

    Raises:
        DataError: If a folder holds no labels.
    """
    labels = read_labels(folder)
    tested = read_labels(test_folder) if test_folder else None
    learned, validation = split_by_stone(
        labels, settings.held_out, np.random.default_rng(settings.seed)
    )
    net = untrained(settings)
    for progress in train(net, learned, validation, settings):
        after_epoch(progress)
    card: dict[str, object] = {
        "labels": read_description(folder),
        "lifted_when_slip_below_m": LIFTED_M,
        "training": settings.model_dump(mode="json"),
        "learned": _counted(learned),
        "validation": _counted(validation) | {"auc": _rounded_auc(net, validation)},
    }
    if tested is not None and test_folder is not None:
        card["test_labels"] = read_description(test_folder)
        card["test"] = _counted(tested) | {"auc": _rounded_auc(net, tested)}
    out.parent.mkdir(parents=True, exist_ok=True)
    save_net(net, out, json.dumps(card, indent=2))
    return card


def _rounded_auc(net: FourLayer | TwoStream, labels: Labels) -> float:
    return round(area_under_curve(*predictions(net, labels)), 4)


def _counted(labels: Labels) -> dict[str, float]:
    lifted = round(float(labels.is_lifted.mean()), 3)
    return {"stones": len(np.unique(labels.stone)), "grasps": len(labels.stone), "lifted": lifted}
