"""Points from text files whose lines begin with x, y and z."""

import re
from pathlib import Path

from executive.arrays import Float
from executive.clouds.file_cloud import FileCloud
from executive.clouds.point_collector import PointCollector
from executive.clouds.text_rows import collect_lines, count_lines
from executive.errors import DataError

_TITLES = re.compile(rb"\s*\"?x\"?[\s,;]+\"?y\"?[\s,;]+\"?z\"?\b[^\n]*\n", re.IGNORECASE)
_COUNT = re.compile(rb"\s*\d+\s*\n")  # a PTS file begins with its number of points


def read_xyz(path: Path) -> Float:
    """Return the points of a text file [m], shape (N, 3).

    A first line of column titles `x y z` and, in PTS files, the number of points are skipped.

    Raises:
        DataError: If a line does not begin with three numbers; the message names the line.
    """
    with path.open("rb") as file:
        beginning = file.read(4096)
    if beginning[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise DataError(f"{path}: is text in UTF-16; save it as UTF-8 or plain ASCII")
    body = beginning.removeprefix(b"\xef\xbb\xbf")
    first = _TITLES.match(body) or (_COUNT.match(body) if path.suffix.lower() == ".pts" else None)
    start = len(beginning) - len(body) + (first.end() if first else 0)
    lines = count_lines(path)
    collector = PointCollector(path, lines)
    collect_lines(path, start, 2 if first else 1, {"x": 0, "y": 1, "z": 2}, lines, collector)
    return collector.points()


def read_xyz_cloud(path: Path) -> FileCloud:
    """Return the points of a text file; its other columns have no names that are known.

    Raises:
        DataError: As `read_xyz`.
    """
    return FileCloud(read_xyz(path), left_out=("columns behind x, y and z",))
