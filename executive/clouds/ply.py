"""Points from PLY files, text or binary of either byte order, in single or double precision."""

from pathlib import Path

from executive.arrays import Float
from executive.clouds.binary_rows import collect_rows
from executive.clouds.ply_header import PlyHeader, read_ply_header
from executive.clouds.point_collector import PointCollector
from executive.clouds.text_rows import collect_lines
from executive.errors import DataError


def read_ply(path: Path) -> Float:
    """Return the points of a PLY file [m], shape (N, 3).

    Raises:
        DataError: If it is cut short, or its header or a line cannot be parsed.
    """
    header = read_ply_header(path)
    collector = PointCollector(path, header.count)
    if header.is_text:
        _collect_text(path, header, collector)
    else:
        collect_rows(path, header.start, header.row, header.count, collector)
    return collector.points()


def _collect_text(path: Path, header: PlyHeader, collector: PointCollector) -> None:
    start = header.start
    with path.open("rb") as file:
        file.seek(start)
        start += sum(
            len(file.readline()) for _ in range(min(header.skipped_lines, path.stat().st_size))
        )
    columns = [header.row.names.index(axis) for axis in "xyz"] if header.row.names else []
    found = collect_lines(
        path, start, header.lines + header.skipped_lines + 1, columns, header.count, collector
    )
    if found < header.count:
        raise DataError(
            f"{path}: cut short: the header promises {header.count} points, the file has {found}; "
            "copy or export it again"
        )
