"""Parts of a cloud as one binary PLY file, one colour each."""

import colorsys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from executive.arrays import Float

_GOLDEN = 0.618034  # turns of hue from part to part: neighbours in number are far apart in colour


def write_parts(path: Path, parts: Sequence[Float]) -> None:
    """Write parts, each (N, 3) [m], as doubles with red, green and blue; empty parts are fine."""
    points = np.vstack([np.empty((0, 3)), *parts])
    hues = [colorsys.hsv_to_rgb(i * _GOLDEN % 1, 0.75, 0.95) for i in range(len(parts))]
    rows = np.empty(len(points), dtype=[("xyz", "<f8", 3), ("rgb", "u1", 3)])
    rows["xyz"] = points
    colours = np.round(255 * np.array(hues).reshape(-1, 3)).astype(np.uint8)
    rows["rgb"] = np.repeat(colours, [len(part) for part in parts], axis=0)
    properties = [f"property double {axis}" for axis in "xyz"] + [
        f"property uchar {c}" for c in ("red", "green", "blue")
    ]
    header = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {len(points)}",
        *properties,
        "end_header",
        "",
    ]
    path.write_bytes("\n".join(header).encode("ascii") + rows.tobytes())
