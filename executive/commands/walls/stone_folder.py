"""The stones of a folder of meshes, and those that were left out, each with its reason."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from executive.clouds.meshes.reader import SUFFIXES, read_mesh
from executive.commands.walls.structure_file import StoneChoice
from executive.errors import ConfigError, DataError
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.solid import is_closed
from executive.messages.solid_stone import SolidStone


def read_stones(
    folder: Path, choice: StoneChoice, rng: np.random.Generator
) -> tuple[tuple[SolidStone, ...], Mapping[str, str]]:
    """Return the stones of a folder, and why others were left out or changed, by their name.

    Raises:
        ConfigError: If there is no such folder.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: no such folder; give one of OBJ, PLY or STL meshes")
    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    if choice.count is not None:
        files = [files[n] for n in rng.permutation(len(files))[: choice.count]]
    stones, told = [], {}
    for path in files:
        try:
            stone, note = _stone(path, choice)
        except DataError as error:
            told[path.name] = f"left out: {error}"
            continue
        stones.append(stone)
        if note:
            told[path.name] = note
    return tuple(stones), told


def _stone(path: Path, choice: StoneChoice) -> tuple[SolidStone, str]:
    vertices, triangles = read_mesh(path)
    vertices, note = vertices * choice.scale, ""
    if not is_closed(triangles) and choice.repair == "hull":
        vertices, triangles = hull_mesh(vertices)
        note = "its mesh is not closed: its convex hull is used"
    stone = SolidStone.of_mesh(path.name, vertices, triangles, choice.density)
    return stone, note
