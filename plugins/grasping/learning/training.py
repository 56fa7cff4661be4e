"""Training of the outcome networks on labels that are split by stone, and its figures of merit."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import torch
from executive_plugins.grasping.classifier.grasp_features import GraspFeatures
from executive_plugins.grasping.classifier.grasp_images import mirrored
from executive_plugins.grasping.classifier.outcome_net import (
    Architecture,
    FourLayer,
    TwoStream,
    load_net,
    new_net,
    success,
)
from executive_plugins.grasping.classifier.weights_file import weights_file
from executive_plugins.grasping.learning.labels import GRAY_LEVELS, Labels
from numpy.typing import NDArray
from pydantic import Field
from scipy.stats import rankdata
from torch import Tensor

from executive.arrays import Float
from executive.config import Settings
from executive.errors import ConfigError


class TrainingSettings(Settings):
    """How a network is trained."""

    architecture: Architecture = Field(
        "two_stream", description="four_layer (the paper's) or two_stream."
    )
    start: str = Field(
        "",
        description="Weights to go on from: shipped ones by name, or a file; new ones if empty. "
        "Their architecture and their scale of numbers are kept.",
    )
    seed: int = Field(1, ge=0, description="Seed of all random draws.")
    epochs: int = Field(12, ge=1, le=1000, description="Passes over the labels.")
    batch: int = Field(64, ge=2, le=4096, description="Labels per step.")
    rate: float = Field(
        1e-3,
        gt=0,
        lt=1,
        description="Largest learning rate of AdamW; it decays along half a cosine.",
    )
    decay: float = Field(1e-3, ge=0, lt=1, description="Weight decay.")
    held_out: float = Field(
        0.15, gt=0, lt=1, description="Share of the stones that is kept for validation."
    )


@dataclass(frozen=True, slots=True)
class Progress:
    """State after an epoch: mean training loss, and area under the ROC curve in validation."""

    epoch: int
    loss: float
    auc: float


def split_by_stone(
    labels: Labels, held_out: float, rng: np.random.Generator
) -> tuple[Labels, Labels]:
    """Return labels for training and for validation; no stone is in both."""
    stones = rng.permutation(np.unique(labels.stone))
    is_held_out = np.isin(labels.stone, stones[: int(np.ceil(held_out * len(stones)))])
    return labels.of_stones(~is_held_out), labels.of_stones(is_held_out)


def train(
    net: FourLayer | TwoStream, learned: Labels, validation: Labels, settings: TrainingSettings
) -> Iterator[Progress]:
    """Train a network in place, epoch by epoch; the weights of the last epoch are the result.

    Batches are mirrored at random at the two symmetry planes of the gripper, since the mirror image
    of a lift has the same outcome.
    """
    rng = np.random.default_rng(settings.seed)
    torch.manual_seed(settings.seed)
    if isinstance(net, TwoStream) and not settings.start:
        net.mean.copy_(torch.from_numpy(learned.numbers.mean(axis=0)))
        net.spread.copy_(torch.from_numpy(learned.numbers.std(axis=0) + 1e-6))
    steps = settings.epochs * int(np.ceil(len(learned.is_lifted) / settings.batch))
    optimiser = torch.optim.AdamW(net.parameters(), lr=settings.rate, weight_decay=settings.decay)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)
    measure = torch.nn.BCEWithLogitsLoss()
    for epoch in range(settings.epochs):
        net.train()
        order, losses = rng.permutation(len(learned.is_lifted)), []
        for batch in np.array_split(order, int(np.ceil(len(order) / settings.batch))):
            images, numbers, wanted = _tensors(learned, batch, rng)
            optimiser.zero_grad()
            loss = measure(net(images, numbers), wanted)
            loss.backward()
            optimiser.step()
            schedule.step()
            losses.append(float(loss.detach()))
        yield Progress(
            epoch + 1, float(np.mean(losses)), area_under_curve(*predictions(net, validation))
        )


def predictions(net: FourLayer | TwoStream, labels: Labels) -> tuple[Float, NDArray[np.bool_]]:
    """Return the predicted success of labelled grasps and their outcome, shape (M,) each."""
    return success(
        net, GraspFeatures(labels.images.astype(np.float32) / GRAY_LEVELS, labels.numbers)
    ), labels.is_lifted


def area_under_curve(score: Float, is_positive: NDArray[np.bool_]) -> float:
    """Return the area under the ROC curve; NaN unless there are positives and negatives.

    It is the probability that a positive scores higher than a negative; ties count half.
    """
    positives, negatives = int(is_positive.sum()), int((~is_positive).sum())
    if not positives or not negatives:
        return float("nan")
    ranks = rankdata(score)[is_positive].sum()
    return float((ranks - positives * (positives + 1) / 2) / (positives * negatives))


def untrained(settings: TrainingSettings) -> FourLayer | TwoStream:
    """Return a network whose initial weights follow from the seed, or are those to go on from.

    Raises:
        ConfigError: If the weights to go on from have another architecture.
        DataError: If they cannot be read.
    """
    if settings.start:
        net = load_net(weights_file(settings.start))
        if type(net) is not type(new_net(settings.architecture)):
            raise ConfigError(f"{settings.start}: no weights of the {settings.architecture}")
        return net
    torch.manual_seed(settings.seed)
    return new_net(settings.architecture)


def _tensors(
    labels: Labels, batch: NDArray[np.int64], rng: np.random.Generator
) -> tuple[Tensor, Tensor, Tensor]:
    images = labels.images[batch].astype(np.float32) / GRAY_LEVELS
    for axis in (1, 2):
        flipped = rng.random(len(batch)) < 0.5
        images[flipped] = mirrored(images[flipped], axis)
    wanted = torch.from_numpy(labels.is_lifted[batch].astype(np.float32))
    return torch.from_numpy(images), torch.from_numpy(labels.numbers[batch]), wanted
