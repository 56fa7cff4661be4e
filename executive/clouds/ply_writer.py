"""Point clouds as binary PLY files."""

import colorsys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from executive.arrays import Float

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
    points = np.vstack([np.empty((0, 3)), *parts])
    hues = [colorsys.hsv_to_rgb(i * _HUE_STEP % 1, 0.75, 0.95) for i in range(len(parts))]
    rows = np.empty(len(points), dtype=[("xyz", "<f8", 3), ("rgb", "u1", 3)])
    rows["xyz"] = points
    colours = np.round(255 * np.array(hues).reshape(-1, 3)).astype(np.uint8)
    rows["rgb"] = np.repeat(colours, [len(part) for part in parts], axis=0)
    comments = (f"comment crs {crs}",) if crs else ()
    _write(path, rows, comments, (*_COORDINATES, *_COLOURS))


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
