"""Point clouds as binary PLY files."""

import colorsys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.clouds.file_cloud import FileCloud, Place

_HUE_STEP = 0.618034  # golden ratio: parts of neighbouring numbers get clearly different hues
_COORDINATES = tuple(f"property double {axis}" for axis in "xyz")
_COLOURS = tuple(f"property uchar {colour}" for colour in ("red", "green", "blue"))


def write_ply(path: Path, points: Float, frame: str) -> None:
    """Write points (N, 3) [m] as little-endian doubles, with the frame's name as a comment."""
    rows = np.ascontiguousarray(points, dtype="<f8")
    _write(path, rows, (f"comment frame {frame}",), _COORDINATES)


def write_parts(path: Path, parts: Sequence[Float], crs: str = "") -> None:
    """Write parts of a cloud, each (N, 3) [m] or empty, into one file, one colour a part.

    The name of their coordinate system, one line of ASCII, becomes a comment if there is one.
    """
    write_ply_cloud(path, coloured_parts(parts, Place(crs)))


def coloured_parts(parts: Sequence[Float], place: Place) -> FileCloud:
    """Return parts of a cloud, each (N, 3) [m] or empty, as one cloud with one colour a part."""
    points = np.vstack([np.empty((0, 3)), *parts])
    hues = [colorsys.hsv_to_rgb(i * _HUE_STEP % 1, 0.75, 0.95) for i in range(len(parts))]
    colours = np.round(255 * np.array(hues).reshape(-1, 3)).astype(np.uint8)
    return FileCloud(points, np.repeat(colours, [len(part) for part in parts], axis=0), place=place)


def write_ply_cloud(path: Path, cloud: FileCloud) -> tuple[str, ...]:
    """Write a cloud with its colour, intensity and coordinate system, and return what is changed.

    The coordinate system becomes a comment, `comment crs NAME`.
    """
    kinds: list[Any] = [("xyz", "<f8", 3)]
    properties = list(_COORDINATES)
    if cloud.colour is not None:
        kinds.append(("rgb", "u1", 3))
        properties += _COLOURS
    if cloud.intensity is not None:
        kinds.append(("intensity", "<f4"))
        properties.append("property float intensity")
    rows = np.empty(len(cloud), dtype=kinds)
    rows["xyz"] = cloud.points
    if cloud.colour is not None:
        rows["rgb"] = cloud.colour_8()
    if cloud.intensity is not None:
        rows["intensity"] = cloud.intensity
    comments = (f"comment crs {cloud.place.crs}",) if cloud.place.crs else ()
    _write(path, rows, comments, properties)
    return cloud.rounding_to_8()


def _write(
    path: Path, rows: np.ndarray, comments: Sequence[str], properties: Sequence[str]
) -> None:
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *comments,
        f"element vertex {len(rows)}",
        *properties,
        "end_header",
        "",
    ]
    path.write_bytes("\n".join(header).encode("ascii") + rows.tobytes())
