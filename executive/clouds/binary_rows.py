"""Coordinates from rows of fixed size in a binary file."""

from pathlib import Path

import numpy as np

from executive.clouds.point_collector import CHUNK, PointCollector


def collect_rows(
    path: Path, start: int, row: np.dtype, count: int, collector: PointCollector
) -> None:
    """Add the x, y and z of `count` rows from a byte on; the file is known to be long enough."""
    with path.open("rb") as file:
        file.seek(start)
        for begun in range(0, count, CHUNK):
            rows = np.fromfile(file, row, min(CHUNK, count - begun))
            collector.add(rows["x"], rows["y"], rows["z"])
