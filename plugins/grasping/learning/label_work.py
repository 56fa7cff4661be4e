"""Labels of grasps as bulk work: a run is a stone."""

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from executive_plugins.grasping.learning.labels import (
    LabelSettings,
    label_stone,
    sampler_of,
    stone_file,
)

from executive.config import Settings
from executive.interfaces.work import Piece, Work

_MACHINE, _WEIGHTS = "machine", "weights"


class GraspLabels(Work):
    """Label the grasps of the stone whose number is the seed."""

    Arguments = LabelSettings
    keeps: ClassVar[tuple[str, ...]] = ("stone_*.npz",)

    def inputs(self, arguments: Settings) -> Mapping[str, Path]:
        """Return the folder of a machine, and the weights, that no installed package brings."""
        settings = _settings(arguments)
        folder, weights = Path(settings.machine), Path(settings.weights)
        brought = {_MACHINE: folder} if folder.is_dir() else {}
        brought |= {_WEIGHTS: weights} if weights.is_file() else {}
        return {name: path.resolve() for name, path in brought.items()}

    def prepare(self, arguments: Settings, inputs: Mapping[str, Path]) -> None:
        """Tabulate what grasps are sampled with, which takes a second."""
        sampler_of(_brought(arguments, inputs).machine)

    def run(self, piece: Piece) -> Mapping[str, object]:
        label_stone(piece.folder, _brought(piece.arguments, piece.inputs), piece.seed)
        return {"file": stone_file(piece.folder, piece.seed).name}


def _settings(arguments: Settings) -> LabelSettings:
    if not isinstance(arguments, LabelSettings):
        raise TypeError(f"expected LabelSettings, got {type(arguments).__name__}")
    return arguments


def _brought(arguments: Settings, inputs: Mapping[str, Path]) -> LabelSettings:
    """Return the settings with the machine's folder and the weights on this computer."""
    return _settings(arguments).model_copy(
        update={name: str(inputs[name]) for name in (_MACHINE, _WEIGHTS) if name in inputs}
    )
