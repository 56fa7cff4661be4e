"""Points from E57 files; they are read in a process with limits of memory and time."""

from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.clouds.file_cloud import FileCloud
from executive.confined.client import read_confined
from executive.extras import require_extra

_READER = "executive.clouds.e57_points"


def read_e57(path: Path) -> Float:
    """Return the points of an E57 file [m], shape (N, 3): those of all scans, moved by their poses.

    Raises:
        MissingExtraError: If the package that reads it is not installed.
        DataError: If it is cut short or damaged, or it asks for more memory or time than its size
            explains.
    """
    return _read(path, "e57_points")[0]


def read_e57_cloud(path: Path) -> FileCloud:
    """Return the points of an E57 file, and the colour and intensity that all of its scans have.

    Raises:
        MissingExtraError: As `read_e57`.
        DataError: As `read_e57`, or if a colour is beyond its range.
    """
    points, colour, intensity, names = _read(path, "e57_cloud")
    left_out = tuple(names.tobytes().decode("utf-8", "replace").split("\n")) if len(names) else ()
    return FileCloud(
        points,
        colour if len(colour) else None,
        intensity if len(intensity) else None,
        left_out=left_out,
    )


def e57_crs(path: Path) -> str:
    """Return the text that names a file's coordinate system; empty if it has none.

    Raises:
        MissingExtraError: As `read_e57`.
        DataError: As `read_e57`.
    """
    return _read(path, "e57_crs")[0].tobytes().decode("utf-8", "replace").strip()


def _read(path: Path, function: str) -> list[np.ndarray]:
    require_extra(f"{path}: an E57 file", "e57")
    return read_confined(f"{_READER}:{function}", path)
