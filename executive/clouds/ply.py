"""Points from PLY files, text or binary of either byte order, in single or double precision."""

from pathlib import Path

from executive.arrays import Float
from executive.clouds.binary_rows import collect_rows
from executive.clouds.carried_fields import CarriedFields, left_out
from executive.clouds.file_cloud import FileCloud
from executive.clouds.ply_header import PlyHeader, read_ply_header
from executive.clouds.point_collector import PointCollector
from executive.clouds.text_rows import collect_lines
from executive.errors import DataError


def read_ply(path: Path) -> Float:
    """Return the points of a PLY file [m], shape (N, 3).

    Raises:
        DataError: If it is cut short, or its header or a line cannot be parsed.
    """
    return _collected(path, read_ply_header(path), CarriedFields()).points()


def read_ply_cloud(path: Path) -> FileCloud:
    """Return the points of a PLY file, their colour and intensity.

    Raises:
        DataError: As `read_ply`, or if a colour is beyond its range.
    """
    header = read_ply_header(path)
    fields = CarriedFields.of(header.row)
    points, carried = _collected(path, header, fields).with_carried()
    return FileCloud.of(points, carried, left_out(header.row.names or (), fields))


def _collected(path: Path, header: PlyHeader, fields: CarriedFields) -> PointCollector:
    collector = PointCollector(path, header.count, fields)
    if header.is_text:
        _collect_text(path, header, fields, collector)
    else:
        collect_rows(path, header.start, header.row, header.count, collector)
    return collector


def _collect_text(
    path: Path, header: PlyHeader, fields: CarriedFields, collector: PointCollector
) -> None:
    start = header.start
    with path.open("rb") as file:
        file.seek(start)
        start += sum(
            len(file.readline()) for _ in range(min(header.skipped_lines, path.stat().st_size))
        )
    names = header.row.names or ()
    columns = {name: names.index(name) for name in (*"xyz", *fields.names)}
    found = collect_lines(
        path, start, header.lines + header.skipped_lines + 1, columns, header.count, collector
    )
    if found < header.count:
        raise DataError(
            f"{path}: cut short: the header promises {header.count} points, the file has {found}; "
            "copy or export it again"
        )
