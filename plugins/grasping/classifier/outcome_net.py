"""Networks that predict whether a lift succeeds, and their files.

The files are safetensors, which hold numbers and no code.
"""

from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
import torch
from executive_plugins.grasping.classifier.grasp_features import NUMBERS, GraspFeatures
from executive_plugins.grasping.classifier.grasp_images import CHANNELS, PIXELS, mirrored
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn

from executive.arrays import Float
from executive.errors import DataError

Architecture = Literal["four_layer", "two_stream"]
_BATCH = 64  # larger batches do not fit into the processor cache
_FORMAT = "executive.grasp_outcome.v1"


class FourLayer(nn.Module):  # type: ignore[misc]  # torch is untyped here
    """The four-layer network that the paper applies (ten Pas et al. 2017, after LeNet).

    It uses images alone: two convolutions of 5 × 5 with pooling and two full layers. It has one
    output, the logit of success, instead of two.
    """

    def __init__(self) -> None:
        super().__init__()
        side = ((PIXELS - 4) // 2 - 4) // 2
        self.layers = nn.Sequential(
            nn.Conv2d(CHANNELS, 20, 5),
            nn.ReLU(),
            nn.MaxPool2d(2),
            nn.Conv2d(20, 50, 5),
            nn.ReLU(),
            nn.MaxPool2d(2),
            nn.Flatten(),
            nn.Dropout(0.5),
            nn.Linear(50 * side * side, 500),
            nn.ReLU(),
            nn.Dropout(0.5),
            nn.Linear(500, 1),
        )

    def forward(self, images: Tensor, numbers: Tensor) -> Tensor:
        """Return logits (M,) of images (M, 15, 32, 32); the numbers are ignored."""
        return self.layers(images)[:, 0]


class TwoStream(nn.Module):  # type: ignore[misc]  # torch is untyped here
    """A network of our own with one stream for images and one for the costs.

    The images pass convolutions of 3 × 3; both streams meet in two full layers.
    """

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(len(NUMBERS)))
        self.register_buffer("spread", torch.ones(len(NUMBERS)))
        widths = (CHANNELS, 24, 48, 64, 64)
        stages = [
            layer
            for before, after in pairwise(widths)
            for layer in (
                nn.Conv2d(before, after, 3, padding=1),
                nn.BatchNorm2d(after),
                nn.ReLU(),
                nn.MaxPool2d(2),
            )
        ]
        side = PIXELS // 2 ** (len(widths) - 1)
        self.seen = nn.Sequential(
            *stages, nn.Flatten(), nn.Dropout(0.4), nn.Linear(widths[-1] * side * side, 64)
        )
        self.counted = nn.Sequential(nn.Linear(len(NUMBERS), 64), nn.ReLU(), nn.Linear(64, 64))
        self.joined = nn.Sequential(
            nn.ReLU(), nn.Dropout(0.3), nn.Linear(128, 64), nn.ReLU(), nn.Linear(64, 1)
        )

    def forward(self, images: Tensor, numbers: Tensor) -> Tensor:
        """Return logits (M,) of images (M, 15, 32, 32) and numbers (M, 9)."""
        counted = self.counted((numbers - self.mean) / self.spread)
        return self.joined(torch.cat([self.seen(images), counted], dim=1))[:, 0]


_ARCHITECTURES: dict[str, type[FourLayer] | type[TwoStream]] = {
    "four_layer": FourLayer,
    "two_stream": TwoStream,
}


def new_net(architecture: Architecture) -> FourLayer | TwoStream:
    """Return an untrained network; its weights are drawn from torch's global generator."""
    return _ARCHITECTURES[architecture]()


def success(net: nn.Module, shown: GraspFeatures) -> Float:
    """Return the predicted probability of success of each grasp, to three digits, shape (M,).

    It is the mean over each grasp and its half turn about the approach, since the jaws are
    symmetric. The rounding hides that the order of summation depends on the number of threads.
    """
    net.eval()
    turned = mirrored(mirrored(shown.images, 1), 2)
    both = [_logits(net, images, shown.numbers) for images in (shown.images, turned)]
    return np.round(1 / (1 + np.exp(-(both[0] + both[1]) / 2)), 3)


def _logits(net: nn.Module, images: NDArray[np.float32], numbers: NDArray[np.float32]) -> Float:
    parts = [np.empty(0)]
    with torch.inference_mode():
        for start in range(0, len(images), _BATCH):
            batch = slice(start, start + _BATCH)
            # The layout "channels last" is twice as fast on a CPU.
            shown = torch.from_numpy(images[batch].copy()).contiguous(
                memory_format=torch.channels_last
            )
            logits = net(shown, torch.from_numpy(numbers[batch].copy()))
            parts.append(logits.numpy().astype(float))
    return np.concatenate(parts)


def save_net(net: FourLayer | TwoStream, path: Path, card: str) -> None:
    """Write the weights of a network with its architecture and a data card (JSON text)."""
    architecture = next(name for name, kind in _ARCHITECTURES.items() if isinstance(net, kind))
    weights = {name: values.contiguous() for name, values in net.state_dict().items()}
    save_file(
        weights, path, metadata={"format": _FORMAT, "architecture": architecture, "card": card}
    )


def load_net(path: Path) -> FourLayer | TwoStream:
    """Read a network; no code in the file is run.

    Raises:
        DataError: If the file is missing, is not a safetensors file, or holds another network.
    """
    try:
        with safe_open(path, framework="pt") as file:
            metadata = file.metadata() or {}
            weights = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - not a mapping
    except (SafetensorError, OSError) as error:
        raise DataError(
            f"{path}: cannot read weights ({error}); train them with `executive grasp-train`"
        ) from error
    if metadata.get("format") != _FORMAT or metadata.get("architecture") not in _ARCHITECTURES:
        raise DataError(
            f"{path}: no weights of a grasp classifier; train them with `executive grasp-train`"
        )
    net = _ARCHITECTURES[metadata["architecture"]]()
    try:
        net.load_state_dict(weights)
    except RuntimeError as error:
        raise DataError(f"{path}: the weights do not fit the network: {error}") from error
    net.to(memory_format=torch.channels_last)
    net.eval()
    return net
