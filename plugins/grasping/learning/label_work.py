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

_MACHINE = "machine"


class GraspLabels(Work):
    """Label the grasps of the stone whose number is the seed."""

    Arguments = LabelSettings
    keeps: ClassVar[tuple[str, ...]] = ("stone_*.npz",)

    def inputs(self, arguments: Settings) -> Mapping[str, Path]:
        """Return the folder of a machine that no installed package brings."""
        folder = Path(_settings(arguments).machine)
        return {_MACHINE: folder.resolve()} if folder.is_dir() else {}

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
    """Return the settings with the machine's folder on this computer."""
    settings = _settings(arguments)
    if _MACHINE not in inputs:
        return settings
    return settings.model_copy(update={_MACHINE: str(inputs[_MACHINE])})
