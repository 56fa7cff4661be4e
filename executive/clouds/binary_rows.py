"""Points from rows of fixed size in a binary file."""

from pathlib import Path

import numpy as np

from executive.clouds.point_collector import CHUNK, PointCollector


def collect_rows(
    path: Path, start: int, row: np.dtype, count: int, collector: PointCollector
) -> None:
    """Add x, y, z and the carried fields of `count` rows to a collector.

    Args:
        path: The file; the caller has checked that it is long enough.
        start: Byte at which the first row begins.
        row: Fields of a row; `x`, `y` and `z` are among them.
        count: Number of rows.
        collector: Receives the points.
    """
    with path.open("rb") as file:
        file.seek(start)
        for begun in range(0, count, CHUNK):
            rows = np.fromfile(file, row, min(CHUNK, count - begun))
            collector.add(rows["x"], rows["y"], rows["z"], rows)
