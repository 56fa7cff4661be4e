"""Points from PCD files: text, binary and compressed."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from executive.arrays import Float
from executive.clouds.binary_rows import collect_rows
from executive.clouds.carried_fields import CarriedFields, left_out
from executive.clouds.file_cloud import FileCloud
from executive.clouds.pcd_header import PcdHeader, read_pcd_header
from executive.clouds.point_collector import CHUNK, PointCollector
from executive.clouds.text_rows import collect_lines
from executive.errors import DataError

if TYPE_CHECKING:
    from executive.clouds.lzf import Unpacker

_MOST_PACKED = 90  # upper bound of the compression ratio: a byte of LZF unpacks to at most 88


def read_pcd(path: Path) -> Float:
    """Return the points of a PCD file [m], shape (N, 3).

    The viewpoint in the header is not applied.

    Raises:
        DataError: If it is cut short, or its header or a line cannot be parsed.
    """
    return _collected(path, read_pcd_header(path), CarriedFields()).points()


def read_pcd_cloud(path: Path) -> FileCloud:
    """Return the points of a PCD file, their colour and intensity.

    Raises:
        DataError: As `read_pcd`, or if a colour is beyond its range.
    """
    header = read_pcd_header(path)
    fields = CarriedFields.of(header.row)
    points, carried = _collected(path, header, fields).with_carried()
    return FileCloud.of(points, carried, left_out(header.row.names or (), fields))


def _collected(path: Path, header: PcdHeader, fields: CarriedFields) -> PointCollector:
    size = path.stat().st_size - header.start
    if header.form == "binary_compressed":
        return _compressed(path, header, size, fields)
    least = header.count * (
        2 * header.columns_of_a_line if header.form == "ascii" else header.row.itemsize
    )
    if size < least - (header.form == "ascii"):
        raise _cut_short(path, header, f"at least {least} bytes", f"{size} bytes")
    collector = PointCollector(path, header.count, fields)
    if header.form == "binary":
        collect_rows(path, header.start, header.row, header.count, collector)
    else:
        columns = header.columns((*"xyz", *fields.names))
        found = collect_lines(
            path, header.start, header.lines + 1, columns, header.count, collector
        )
        if found < header.count:
            raise _cut_short(path, header, "a line each", f"{found} lines")
    return collector


def _compressed(path: Path, header: PcdHeader, size: int, fields: CarriedFields) -> PointCollector:
    """Collect the points of a compressed file, which stores all x, then all y, and so on."""
    from executive.clouds.lzf import Unpacker  # imports numba: only compressed files need it

    with path.open("rb") as file:
        file.seek(header.start)
        lengths = np.frombuffer(file.read(8).ljust(8, b"\0"), dtype="<u4")
        packed = np.frombuffer(file.read(), dtype=np.uint8)
    wanted = header.count * header.row.itemsize
    if len(packed) < lengths[0]:
        raise _cut_short(path, header, f"{lengths[0]} packed bytes", f"{max(0, size - 8)} bytes")
    if lengths[1] < wanted or wanted > _MOST_PACKED * len(packed):
        raise DataError(
            f"{path}: {header.count} points cannot be in {len(packed)} packed bytes; "
            "export it again"
        )
    collector = PointCollector(path, header.count, fields)
    columns = _columns(header, (*"xyz", *fields.names), Unpacker(packed[: lengths[0]]))
    for begun in range(0, header.count, CHUNK):
        count = min(CHUNK, header.count - begun)
        sizes = {name: count * header.row[name].itemsize for name in columns}
        bytes_of = {name: column.take(sizes[name]) for name, column in columns.items()}
        if any(len(bytes_of[name]) < size for name, size in sizes.items()):
            raise DataError(f"{path}: its compressed points are damaged; copy or export it again")
        piece = {name: some.view(header.row[name]) for name, some in bytes_of.items()}
        collector.add(piece["x"], piece["y"], piece["z"], piece)
    return collector


def _columns(header: PcdHeader, names: Sequence[str], whole: "Unpacker") -> dict[str, "Unpacker"]:
    """Return for each field an unpacker that stands where its column begins.

    The columns are read side by side, each from a place of its own, so that a file that unpacks to
    90 times its size takes no more memory than another.
    """
    columns, passed = {}, 0
    for name in sorted(names, key=header.offset):
        start = header.count * header.offset(name)
        whole.skip(start - passed)
        columns[name], passed = whole.copy(), start
    return columns


def _cut_short(path: Path, header: PcdHeader, wanted: str, found: str) -> DataError:
    return DataError(
        f"{path}: cut short: the header promises {header.count} points ({wanted}), the "
        f"file has {found}; copy or export it again"
    )
